// A disk that takes long, or for ever, to make safe what is written: rows are committed all the
// same, none is lost, and the log ends where it should.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "../support/temporary_directory.hpp"
#include "faulty_disk.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/recording/recording_writer.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

using WhenFull = RecordingWriter::WhenFull;

constexpr double kLostAtMost = 0.2;  // s
constexpr std::uintmax_t kPage = 4096;

RecordingInfo info_with_state() {
  RecordingInfo info;
  info.simulation_rate = 1000.0;
  info.with_state = true;
  info.fingers.push_back({.name = "index", .configuration_names = {"travel_mm"}});
  return info;
}

/// As large as two pages: a second of them is more than a log gets.
StepRecord step_with_state(std::int64_t number) {
  StepRecord step;
  step.step = number;
  step.nodes_W.assign(300, Vector3(1.0, 2.0, static_cast<double>(number)));
  return step;
}

bool comes_true(const std::function<bool()>& condition) {
  for (int i = 0; i < 2000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

std::int64_t last_committed(const fs::path& file) { return RecordingReader(file).last_step(); }

/// Steps of a recording, from 0 on without a gap.
std::int64_t steps_without_gap(const fs::path& file) {
  RecordingReader reader(file);
  std::int64_t count = 0;
  for (StepRecord step; reader.next(step); ++count) {
    if (step.step != count || step.nodes_W != step_with_state(count).nodes_W) {
      ADD_FAILURE() << "step " << step.step << " in the place of " << count;
      break;
    }
  }
  return count;
}

std::uintmax_t log_size(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file.string() + "-wal", error);
  return error ? 0 : size;
}

/// Where a disk is only as slow as a test makes it.
fs::path in_memory() {
  const fs::path place = "/dev/shm";
  return fs::is_directory(place) ? place : fs::temp_directory_path();
}

/// A recording that grows on a disk.
struct Growing {
  explicit Growing(FaultyDisk& on, WhenFull when_full, LogLimits limits = {})
      : disk(on),
        writer(directory / "run.db", info_with_state(), when_full, step_with_state(0), limits) {
    disk.watch();
  }
  ~Growing() {
    disk.release();
    disk.end_delays();
  }

  void push() {
    times.at(static_cast<std::size_t>(steps)) = monotonic_time();
    writer.push(step_with_state(steps));
    ++steps;
  }
  /// Steps at 1 kHz until `condition`.
  bool push_until(const std::function<bool()>& condition) {
    for (int i = 0; i < 10'000; ++i) {
      if (condition()) return true;
      push();
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }
  bool commits_what_was_pushed() {
    return comes_true([&] { return last_committed(file) == steps - 1; });
  }
  /// What a kill now loses of what there is up to `now`, s.
  [[nodiscard]] double lost(const fs::path& there, double now) const {
    return now - times[static_cast<std::size_t>(last_committed(there))];
  }
  void expect_all() {
    disk.release();
    disk.end_delays();
    writer.close();
    EXPECT_EQ(writer.dropped(), 0U);
    EXPECT_EQ(steps_without_gap(file), steps);
    EXPECT_FALSE(fs::exists(file.string() + "-wal"));
  }

  FaultyDisk& disk;
  TemporaryDirectory directory{in_memory()};
  fs::path file = directory / "run.db";
  std::vector<std::atomic<double>> times = std::vector<std::atomic<double>>(20'000);  ///< s
  std::atomic<std::int64_t> steps{0};
  RecordingWriter writer;
};

/// The least of up to five tries: a machine may hold one up.
double least_of_five(double enough, const std::function<double()>& attempt) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5 && !(least < enough) && !testing::Test::HasFailure(); ++i) {
    least = std::min(least, attempt());
  }
  return least;
}

TEST(SlowDisk, RowsAreCommittedWhileASyncHangs) {
  FaultyDisk disk(DiskDelays{});
  Growing run(disk, WhenFull::kWait);
  disk.hold(Held::kSyncs);
  const long ended = disk.syncs_ended();
  const long begun = disk.syncs_begun();
  ASSERT_TRUE(run.push_until([&] { return disk.syncs_begun() > begun; }));
  for (int i = 0; i < 100; ++i) run.push();
  EXPECT_TRUE(run.commits_what_was_pushed());
  EXPECT_EQ(disk.syncs_ended(), ended) << "it hangs still";
  run.expect_all();
}

TEST(SlowDisk, RowsAreCommittedWhileACopyOfTheLogHangs) {
  FaultyDisk disk(DiskDelays{});
  Growing run(disk, WhenFull::kWait);
  disk.hold(Held::kWritesToFiles);
  ASSERT_TRUE(run.push_until([&] { return disk.writes_to_files() > 0; }));
  for (int i = 0; i < 100; ++i) run.push();
  EXPECT_TRUE(run.commits_what_was_pushed());
  EXPECT_EQ(disk.writes_to_files(), 1) << "it hangs still";
  run.expect_all();
}

/// Records at 1 kHz for 3 s where a sync takes a second.
/// \returns the most (s) that a kill would have lost at any time, and what was.
double lost_at_most() {
  FaultyDisk disk(DiskDelays{.sync = 1s});
  Growing run(disk, WhenFull::kDrop);
  const long begun = disk.syncs_begun();
  const double start = monotonic_time();
  std::thread producer([&] {
    for (int i = 0; i < 3000; ++i) {
      run.push();
      std::this_thread::sleep_for(
          std::chrono::duration<double>(start + 1e-3 * i - monotonic_time()));
    }
  });
  double most = 0.0;
  while (run.steps < 3000) {
    const std::int64_t pushed = run.steps;
    const double now = monotonic_time();
    if (pushed > 200) most = std::max(most, run.lost(run.file, now));
    std::this_thread::sleep_for(5ms);
  }
  producer.join();
  EXPECT_GT(disk.syncs_begun(), begun);
  EXPECT_EQ(disk.syncs_by_who_writes_logs(), 0);
  disk.end_delays();
  run.writer.close();
  const std::uint64_t dropped = run.writer.dropped();
  if (dropped == 0) {
    EXPECT_EQ(steps_without_gap(run.file), 3000);
  }
  return most + static_cast<double>(dropped) * 1e-3;
}

TEST(SlowDisk, NothingIsLostOrLateWhileEachSyncTakesASecond) {
  EXPECT_LT(least_of_five(kLostAtMost, lost_at_most), kLostAtMost);
}

/// Copies file and log of a run whose disk hangs, half a second after that.
/// \returns by how much (s) what is there ends before that.
double lost_by_a_cut() {
  FaultyDisk disk(DiskDelays{});
  Growing run(disk, WhenFull::kDrop);
  disk.hold(Held::kSyncs);
  const long begun = disk.syncs_begun();
  EXPECT_TRUE(run.push_until([&] { return disk.syncs_begun() > begun; }));
  const double hangs = monotonic_time();
  EXPECT_TRUE(run.push_until([&] { return monotonic_time() > hangs + 0.5; }));
  const double cut = monotonic_time();
  const fs::path copy = run.directory / "copy.db";
  fs::copy(run.file, copy);
  fs::copy(run.file.string() + "-wal", copy.string() + "-wal");
  const std::uint64_t dropped = run.writer.dropped();
  if (dropped == 0) {
    EXPECT_GT(steps_without_gap(copy), 500);
  }
  return run.lost(copy, cut) + static_cast<double>(dropped) * 1e-3;
}

TEST(SlowDisk, ARunThatIsCutWhileASyncHangsLosesAFifthOfASecond) {
  EXPECT_LT(least_of_five(kLostAtMost, lost_by_a_cut), kLostAtMost);
}

TEST(SlowDisk, WhoWritesTheLogNeverSyncsAndTheLogBeginsAnew) {
  FaultyDisk disk(DiskDelays{});
  Growing run(disk, WhenFull::kWait);
  std::uintmax_t longest = 0;
  int anew = 0;
  std::uintmax_t before = 0;
  ASSERT_TRUE(run.push_until([&] {
    const std::uintmax_t now = log_size(run.file);
    longest = std::max(longest, now);
    anew += now < before ? 1 : 0;
    before = now;
    return run.steps == 5000;
  }));
  EXPECT_TRUE(run.commits_what_was_pushed());
  EXPECT_GT(anew, 1);
  EXPECT_LT(longest, 4 * 1000 * kPage) << "of 10000 pages that there are";
  EXPECT_GT(disk.syncs_begun(), 5);
  EXPECT_EQ(disk.syncs_by_who_writes_logs(), 0);
  EXPECT_FALSE(run.writer.waited_for_disk());
  run.expect_all();
}

TEST(SlowDisk, InAPauseTheLogIsEmptiedAndNobodyWaitsAfterIt) {
  FaultyDisk disk(DiskDelays{.sync = 300ms});
  Growing run(disk, WhenFull::kWait);
  ASSERT_TRUE(run.push_until([&] { return log_size(run.file) > 1100 * kPage; }));
  EXPECT_TRUE(comes_true([&] { return log_size(run.file) == 0; }));
  disk.hold(Held::kSyncs);
  for (int i = 0; i < 100; ++i) run.push();
  EXPECT_TRUE(run.commits_what_was_pushed());
  EXPECT_EQ(disk.syncs_by_who_writes_logs(), 0);
  run.expect_all();
}

TEST(SlowDisk, AtItsLongestTheLogWaitsForTheDisk) {
  FaultyDisk disk(DiskDelays{.sync = 100ms});
  Growing run(disk, WhenFull::kWait, {.copied_each = 20, .longest = 600});
  std::uintmax_t longest = 0;
  EXPECT_FALSE(run.writer.waited_for_disk());
  ASSERT_TRUE(run.push_until([&] {
    longest = std::max(longest, log_size(run.file));
    return run.steps == 3000;
  }));
  EXPECT_TRUE(run.writer.waited_for_disk());
  EXPECT_GT(longest, 200 * kPage) << "it grew first";
  EXPECT_LT(longest, 3000 * kPage) << "of 6000 pages that there are";
  EXPECT_EQ(disk.syncs_by_who_writes_logs(), 0);
  run.expect_all();
}

TEST(SlowDisk, WhereEachWriteIsSlowAllThatIsNotDroppedIsThere) {
  FaultyDisk disk(DiskDelays{.write = 1ms});
  Growing run(disk, WhenFull::kDrop);
  for (int i = 0; i < 1000; ++i) run.push();
  disk.end_delays();
  run.writer.close();
  EXPECT_GT(run.writer.dropped(), 0U) << "too many at once";
  RecordingReader reader(run.file);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.dropped(), static_cast<std::int64_t>(run.writer.dropped()));
  std::int64_t rows = 0;
  for (StepRecord step; reader.next(step); ++rows) {
    EXPECT_EQ(step.nodes_W, step_with_state(step.step).nodes_W);
  }
  EXPECT_EQ(rows + reader.dropped(), 1000);
}

}  // namespace
}  // namespace softfinger
