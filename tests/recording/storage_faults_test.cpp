// A disk that fails at any one of the operations of a recording: what is there afterwards is a
// recording from its beginning to some step, or says that it is none.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "../support/temporary_directory.hpp"
#include "faulty_disk.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/recording/recording_writer.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kSteps = 400;

RecordingInfo plain_info() {
  RecordingInfo info;
  info.scene = "/scene.toml";
  info.simulation_rate = 1000.0;
  info.fingers.push_back({.name = "index", .configuration_names = {"travel_mm"}, .joints = 1});
  info.files.push_back({"/scene.toml", std::string(3000, 'x')});
  return info;
}

StepRecord plain_step(std::int64_t step) {
  StepRecord record;
  record.step = step;
  record.time = static_cast<double>(step) / 1000.0;
  record.normal_force = static_cast<double>(step) / 7.0;
  record.hash = 0x9e3779b97f4a7c15U * static_cast<std::uint64_t>(step + 1);
  return record;
}

enum class Written { kNothing, kPart, kAll };

/// A run whose log is as short as it may be, and is emptied several times.
struct ShortLog {
  static constexpr LogLimits kLimits{.copied_each = 8, .longest = 16};
  /// More than what is committed at once comes between these.
  static void rest(std::int64_t step) {
    if (step % 100 == 99) std::this_thread::sleep_for(std::chrono::milliseconds(75));
  }
};

/// What the writer says has become of it.
Written record(const fs::path& file, bool short_log = false) {
  try {
    RecordingWriter writer(file, plain_info(), RecordingWriter::WhenFull::kWait, plain_step(0),
                           short_log ? ShortLog::kLimits : LogLimits{});
    for (std::int64_t step = 0; step < kSteps; ++step) {
      writer.push(plain_step(step));
      if (short_log) ShortLog::rest(step);
    }
    try {
      writer.close();
      return Written::kAll;
    } catch (const OperationError&) {
      return Written::kPart;
    }
  } catch (const OperationError&) {
    return Written::kNothing;
  }
}

/// Steps of a recording, which are right and without a gap; -1: it says that it is none.
std::int64_t steps_of(const fs::path& file) {
  try {
    RecordingReader reader(file);
    StepRecord step;
    std::int64_t count = 0;
    for (; reader.next(step); ++count) {
      EXPECT_EQ(first_difference(plain_step(count), step), nullptr) << count;
      if (testing::Test::HasFailure()) return count;
    }
    EXPECT_TRUE(!reader.complete() || count == kSteps) << count;
    return count;
  } catch (const InputError&) {
    return -1;
  }
}

class StorageFaults : public testing::TestWithParam<DiskFault> {};
constexpr std::array kFaultNames{"Full", "Torn", "NoSync", "Broken", "PowerCut", "Unsynced"};
INSTANTIATE_TEST_SUITE_P(Disks, StorageFaults,
                         testing::Values(DiskFault::kFull, DiskFault::kTorn, DiskFault::kNoSync,
                                         DiskFault::kBroken, DiskFault::kPowerCut,
                                         DiskFault::kUnsynced),
                         [](const auto& fault) {
                           return std::string(
                               kFaultNames.at(static_cast<std::size_t>(fault.param)));
                         });

bool is_told(DiskFault fault) {
  return fault != DiskFault::kPowerCut && fault != DiskFault::kUnsynced;
}

/// Records on a disk that fails at its `at`th operation.
/// \returns how many steps are there then; -1: it says that it is none.
std::int64_t steps_after(DiskFault fault, long at, const fs::path& file, bool short_log) {
  Written written = Written::kNothing;
  bool emptied = false;
  {
    const FaultyDisk disk(fault, at);
    written = record(file, short_log);
    emptied = disk.truncated_logs() > 0;
  }
  // What processes share of a log is gone with them.
  if (!is_told(fault)) fs::remove(file.string() + "-shm");
  const std::int64_t steps = steps_of(file);
  if (written == Written::kAll && is_told(fault)) {
    EXPECT_EQ(steps, kSteps);
  }
  if (emptied) {
    EXPECT_GT(steps, 0) << "what was in the log is in the file";
  }
  return steps;
}

TEST_P(StorageFaults, LeaveARecordingUpToSomeStepOrNone) {
  const TemporaryDirectory directory;
  long operations = 0;
  {
    const FaultyDisk sound(GetParam(), 1'000'000);
    ASSERT_EQ(record(directory / "sound.db"), Written::kAll);
    operations = sound.operations();
  }
  ASSERT_EQ(steps_of(directory / "sound.db"), kSteps);
  ASSERT_GT(operations, 20);
  int cut = 0;
  int whole = 0;
  // All of the first and the last ones, where it is made and closed, and some between.
  for (long at = 0; at < operations + 3; at += at < 12 || at > operations - 25 ? 1 : 5) {
    SCOPED_TRACE(at);
    const fs::path file = directory / ("run-" + std::to_string(at) + ".db").c_str();
    const std::int64_t steps = steps_after(GetParam(), at, file, false);
    (steps == kSteps ? whole : cut) += 1;
    if (HasFailure()) return;
  }
  EXPECT_GT(cut, 3);
  EXPECT_GT(whole, 0);
}

// Where another thread copies and empties the log: which operation is the `at`th differs from run
// to run.
TEST_P(StorageFaults, LeaveTheSameOfARunWhoseLogIsEmptied) {
  const TemporaryDirectory directory;
  long operations = 0;
  long emptied = 0;
  // On a busy machine that thread may come too late for one run.
  for (int attempt = 0; attempt < 10 && emptied == 0; ++attempt) {
    const fs::path file = directory / ("sound-" + std::to_string(attempt) + ".db").c_str();
    {
      const FaultyDisk sound(GetParam(), 1'000'000);
      ASSERT_EQ(record(file, true), Written::kAll);
      operations = sound.operations();
      emptied = sound.truncated_logs();
    }
    ASSERT_EQ(steps_of(file), kSteps);
  }
  ASSERT_GT(emptied, 0);
  for (long at = 30; at < operations + 3 && !HasFailure(); at += 11) {
    SCOPED_TRACE(at);
    const fs::path file = directory / ("run-" + std::to_string(at) + ".db").c_str();
    (void)steps_after(GetParam(), at, file, true);
  }
}

}  // namespace
}  // namespace softfinger
