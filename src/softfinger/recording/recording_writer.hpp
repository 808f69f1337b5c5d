#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "softfinger/recording/checkpointer.hpp"
#include "softfinger/recording/record.hpp"
#include "softfinger/recording/recording_info.hpp"
#include "softfinger/threads/ring_buffer.hpp"

namespace softfinger {

/// Throws InputError where a recording could not begin in `file`: it exists, or its folder takes
/// no file. Creates nothing.
void refuse_unless_recordable(const std::filesystem::path& file);

/// Writes a recording: one SQLite file in write-ahead log mode, readable while it is written.
///
/// Loops hand rows over through bounded rings, one a producing thread; a thread of the writer's own
/// commits them at least every kCommitInterval, so that a kill loses no more than that, one
/// round of its work and what a Checkpointer lets it rest. That thread waits for no sync. Tables
/// (SI units; hashes are the signed reading of 64 bits):
///
///     meta(key, value)              format_version, program_version, instruction_set, scene,
///                                   simulation_rate_Hz, live, with_state, dropped, complete
///     files(path, content)          every file the run was built from
///     fingers(finger, name, model, device, tracker, configuration_names, joints, device_rate_Hz)
///     steps(step, finger, ...)      one StepRecord a row (kStepFields); step 0 is the starting
///                                   pose
///     ticks(step, finger, tick, ...)   one TickRecord a row (kTickFields); vectors are float64
///     blobs,
///                                   little-endian
///     moving_objects(object, name, joint_unit)
///     objects(step, object, ...)    one ObjectRecord a row (kObjectFields); step 0 is the start
///     object_names(object, name)    of all objects, where any moves
///     events(step, number, ...)     one EventRecord a row (kEventFields)
///     bones(step, object, ...)      one FollowRecord a row (kFollowFields), where it changes
///     messages(number, step, time_s, since_start_s, message)   what people were told: one
///                                   RecordedMessage a row
///     states(step, finger, nodes, samples)   with_state only; float64 blobs, row by row:
///                                   nodes x y z in W; samples x y z gap fx fy fz in_contact in F
///     object_states(step, object, nodes)     with_state only, of soft objects; likewise
class RecordingWriter {
 public:
  /// What a producer does where its ring is full: a headless run waits, a live run never does.
  enum class WhenFull { kWait, kDrop };
  static constexpr double kCommitInterval = 0.05;  ///< s, wall time

  /// Creates the file. The prototypes have the sizes of the largest nodes_W and samples.
  /// Throws InputError where the file exists or cannot be created.
  RecordingWriter(const std::filesystem::path& file, const RecordingInfo& info, WhenFull when_full,
                  const StepRecord& step_prototype, LogLimits log = {},
                  const ObjectRecord& object_prototype = {});
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Simulation thread only. Copies the record; allocates nothing, takes no lock.
  void push(const StepRecord& record);
  /// Simulation thread only. Copies the record; allocates nothing, takes no lock.
  void push(const ObjectRecord& record);
  /// Simulation thread only. Copies the record; allocates nothing, takes no lock.
  void push(const EventRecord& record);
  /// Simulation thread only. Copies the record; allocates nothing, takes no lock.
  void push(const FollowRecord& record);
  /// One thread per finger. Copies the record; allocates nothing, takes no lock.
  void push(const TickRecord& record);

  /// A line that people were told, after this step, at this time (s) of the run. One thread, none
  /// of the loops.
  void push(std::int64_t step, double time, const std::string& message);

  /// Writes what is left, marks the recording complete and closes the file. Throws OperationError
  /// when something could not be written. Called once, after the producers have ended.
  void close();

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// Rows not recorded because a ring was full.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }
  /// The file can no longer be written (disk full, removed); rows are thrown away since.
  [[nodiscard]] bool failed() const { return failed_.load(std::memory_order_relaxed); }
  /// The disk is so slow that the log is at its longest and rows have waited for it; a kill may
  /// have lost more meanwhile.
  [[nodiscard]] bool waited_for_disk() const { return checkpointer_->held_writer_up(); }

 private:
  static constexpr std::size_t kMostMessages = 1000;  ///< that wait to be written

  struct Database;
  template <typename Record>
  void push_to(RingBuffer<Record>& ring, const Record& record);
  void write_until_closed();
  [[nodiscard]] bool rows_wait();
  [[nodiscard]] bool may_write();  ///< and a transaction has begun
  void begin(Checkpointer::Begin how);
  void commit();
  void write_messages();
  bool drain();  ///< says whether there may be more

  std::filesystem::path file_;
  WhenFull when_full_;
  RingBuffer<StepRecord> steps_;
  std::vector<std::unique_ptr<RingBuffer<TickRecord>>> ticks_;  // one per finger
  RingBuffer<ObjectRecord> objects_;
  RingBuffer<EventRecord> events_;
  RingBuffer<FollowRecord> bones_;
  std::mutex messages_mutex_;  ///< of the next line
  std::vector<RecordedMessage> messages_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::unique_ptr<Database> database_;
  std::unique_ptr<Checkpointer> checkpointer_;
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<bool> failed_{false};
  std::atomic<bool> closing_{false};
  std::thread thread_;
};

}  // namespace softfinger
