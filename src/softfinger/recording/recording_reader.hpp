#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "softfinger/recording/record.hpp"
#include "softfinger/recording/recording_info.hpp"

namespace softfinger {

/// Reads a recording, complete, cut by a kill, or still being written. Every call throws InputError
/// where the file is no recording or is damaged.
class RecordingReader {
 public:
  explicit RecordingReader(const std::filesystem::path& file);
  ~RecordingReader();
  RecordingReader(RecordingReader&&) noexcept;
  RecordingReader& operator=(RecordingReader&&) noexcept;

  [[nodiscard]] const RecordingInfo& info() const { return info_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// Rows that a live run could not record in time.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }
  /// Whether the run closed it.
  [[nodiscard]] bool complete() const { return complete_; }
  /// One line for people where it did not, else empty.
  [[nodiscard]] std::string how_it_was_cut();

  /// Number of the last step recorded; 0 if there is none.
  [[nodiscard]] std::int64_t last_step();
  /// Next step in order of (step, finger); false at the end.
  bool next(StepRecord& record);
  /// Next tick in order of (step, finger, tick); false at the end.
  bool next(TickRecord& record);
  /// Next row of an object in order of (step, object); false at the end, or where none moved.
  bool next(ObjectRecord& record);
  /// Next event in order of (step, number); false at the end, or where none moved.
  bool next(EventRecord& record);
  /// Next row of a bone of a hand in order of (step, object); false at the end, or without hands.
  bool next(FollowRecord& record);
  /// In the order in which they were told; none in recordings from before there were any.
  [[nodiscard]] std::vector<RecordedMessage> messages();
  /// Starts all over.
  void rewind();
  /// Told now and then, by next(), how much of the steps is read since the start, 0 to 1. What it
  /// throws ends the reading.
  void watch(std::function<void(double)> watch);

 private:
  struct Database;
  [[nodiscard]] std::unique_ptr<Database> open() const;
  [[nodiscard]] std::unique_ptr<Database> roll_back() const;
  [[noreturn]] void fail() const;

  std::filesystem::path file_;
  RecordingInfo info_;
  std::int64_t dropped_ = 0;
  bool complete_ = false;
  void tell(std::int64_t step);

  std::unique_ptr<Database> database_;
  std::function<void(double)> watch_;
  std::int64_t last_step_ = 0;  ///< for the watch
  int untold_ = 0;              ///< rows
};

}  // namespace softfinger
