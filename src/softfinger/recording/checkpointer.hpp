#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

namespace softfinger {

/// How long the write-ahead log of a recording gets, in pages of 4 KiB.
struct LogLimits {
  int copied_each = 1000;  ///< it is copied each time that it has grown by so much
  int longest = 262'144;   ///< from here on who writes waits for the disk
};

/// Copies the write-ahead log of a recording into its file and empties it, on a thread of its own,
/// so that who writes rows waits for no sync (fsync), however long a disk takes for one.
///
/// A log can only be emptied once all of it is safe in the file, so while nothing is added to it.
/// For that the writer rests between two transactions, but no longer than kMostRest with rows that
/// wait: a disk that is quicker than that keeps the log at copied_each and what came meanwhile. On
/// a slower one the log is copied but grows, is tried again at twice its length, and only at
/// `longest` the writer rests until the disk has done its work. What fails leaves the log as it is,
/// for the one who closes the recording.
class Checkpointer {
 public:
  static constexpr double kMostRest = 0.05;  ///< s, wall time

  /// What a transaction of the writer should do.
  enum class Begin {
    kLater,
    kNow,
    kInEmptyLog,  ///< now, and the log's header needs no sync: nothing older is there to mix with
  };

  /// `file` is a recording with a log; its thread opens it.
  Checkpointer(std::filesystem::path file, LogLimits limits);
  ~Checkpointer() { stop(); }
  Checkpointer(const Checkpointer&) = delete;
  Checkpointer& operator=(const Checkpointer&) = delete;

  /// The writing thread, where it has rows and no transaction. Unless it is told kLater it has one
  /// until it calls committed().
  [[nodiscard]] Begin begin();
  /// The same, and is never told kLater.
  [[nodiscard]] Begin begin_at_once();
  void committed(int log_pages);

  /// Waits for the sync that goes on, and begins no other.
  void stop();

  /// The log has been at its longest, and rows have waited for the disk.
  [[nodiscard]] bool held_writer_up() const { return held_up_.load(std::memory_order_relaxed); }

 private:
  class Log;
  using Lock = std::unique_lock<std::mutex>;
  [[nodiscard]] bool must_rest();
  void run();
  void follow_log(Log& log, Lock& lock);
  void copy(Log& log, Lock& lock);
  void copy_rest(Log& log, Lock& lock);
  [[nodiscard]] bool empty(Log& log, Lock& lock);

  std::filesystem::path file_;
  LogLimits limits_;
  std::mutex mutex_;  ///< of the next ones; held for no sync
  std::condition_variable changed_;
  bool stopping_ = false;
  bool writing_ = false;      ///< a transaction has begun
  bool rest_wanted_ = false;  ///< until it is broken, or of no use any more
  bool log_is_empty_ = false;
  int pages_ = 0;           ///< of the log
  int copied_ = 0;          ///< of them; its own thread only
  int copy_at_, empty_at_;  ///< pages
  std::optional<std::chrono::steady_clock::time_point> resting_since_;  ///< with rows that wait
  std::atomic<bool> held_up_{false};
  std::thread thread_;
};

}  // namespace softfinger
