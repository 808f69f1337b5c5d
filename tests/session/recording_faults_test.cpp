// A disk that fills up and a process that is killed while a run is recorded: nothing is lost but
// the last 0.2 s, what is there can be read and replayed, and the run goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <new>
#include <thread>

#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "largest_file.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/recording/recording_writer.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/replay.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

constexpr double kMayBeLost = 0.2;  // s
// So slowed down, a loop leaves its recorder hardly any processor.
#ifdef SOFTFINGER_SANITIZED
constexpr double kMayBeLostByALoop = 1.0;
#else
constexpr double kMayBeLostByALoop = kMayBeLost;
#endif
constexpr std::size_t kRoom = 3 << 20;  // bytes

/// A disk of few bytes, where this process may have one.
class SmallDisk {
 public:
  explicit SmallDisk(std::size_t bytes) {
    const std::string size = "size=" + std::to_string(bytes);
    mounted_ = ::mount("tmpfs", place().c_str(), "tmpfs", 0, size.c_str()) == 0;
  }
  ~SmallDisk() {
    if (mounted_) ::umount2(place().c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  [[nodiscard]] bool mounted() const { return mounted_; }
  [[nodiscard]] std::filesystem::path place() const { return directory_ / "."; }

 private:
  TemporaryDirectory directory_;
  bool mounted_ = false;
};

/// Where files are in memory, if there is such a place: how long a busy disk takes is not the
/// recorder's.
std::filesystem::path memory() {
  const std::filesystem::path place = "/dev/shm";
  return std::filesystem::is_directory(place) ? place : std::filesystem::temp_directory_path();
}

/// The least that `attempt` loses (s) in up to five tries: a machine may hold one up by more than
/// may be lost, a recorder that keeps too much in hand loses it in each.
template <class Attempt>
double least_lost(double may_be_lost, const Attempt& attempt) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5 && !(least < may_be_lost); ++i) least = std::min(least, attempt());
  return least;
}

/// Records at 1 kHz until the recording can no longer be written, and half a second more.
/// \returns by how much (s) what is there ends before that.
double lost_where_room_ends(const std::filesystem::path& file) {
  std::filesystem::remove(file);
  RecordingInfo info;
  info.simulation_rate = 1000.0;
  info.with_state = true;
  info.fingers.push_back({.name = "index", .configuration_names = {"travel_mm"}});
  StepRecord record;
  record.nodes_W.assign(300, Vector3(1.0, 2.0, 3.0));
  RecordingWriter writer(file, info, RecordingWriter::WhenFull::kDrop, record);
  double failed = 0.0;
  const double began = monotonic_time();
  for (record.step = 0; failed == 0.0 || monotonic_time() - failed < 0.5; ++record.step) {
    if (monotonic_time() - began > 60.0) {
      ADD_FAILURE() << "the disk never fills";
      break;
    }
    record.time = monotonic_time();
    writer.push(record);
    if (failed == 0.0 && writer.failed()) failed = record.time;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(writer.dropped(), 0u) << "the loop is not held up, nor its ring full";
  try {
    writer.close();
    ADD_FAILURE() << "closed as if nothing were lost";
  } catch (const OperationError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("could not be written to its end"));
  }
  // The disk is still full.
  RecordingReader reader(file);
  EXPECT_FALSE(reader.complete());
  StepRecord step;
  std::int64_t rows = 0;
  while (reader.next(step)) EXPECT_EQ(step.step, rows++) << "nothing is missing in between";
  EXPECT_GT(rows, 50);
  return failed - step.time;
}

TEST(RecordingFaults, AFileThatMayNotGrow) {
  const TemporaryDirectory directory(memory());
  const LargestFile limit(kRoom);
  EXPECT_LT(least_lost(kMayBeLost, [&] { return lost_where_room_ends(directory / "run.db"); }),
            kMayBeLost);
}

TEST(RecordingFaults, AFullDisk) {
  const SmallDisk disk(kRoom);
  if (!disk.mounted()) GTEST_SKIP() << "only who may mount can try a full disk";
  EXPECT_LT(least_lost(kMayBeLost, [&] { return lost_where_room_ends(disk.place() / "run.db"); }),
            kMayBeLost);
}

/// \returns by how much (s) the replay of a live run whose recording may not grow ends before the
/// run said so.
double lost_by_a_live_run(const std::filesystem::path& file) {
  std::filesystem::remove(file);
  const ScenesWithoutForceLimit scenes;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.duration = 2.0;
  options.twin = false;
  options.recording = file;
  options.record_state = true;
  std::vector<std::string> told;
  double reached = 0.0;
  double told_at = 0.0;
  RunObserver observer;
  observer.progress = [&](double time, std::optional<double>) { reached = time; };
  observer.message = [&](const std::string& line) {
    if (line.find("can no longer be written; the run goes on") == std::string::npos) return;
    told.push_back(line);
    told_at = reached;
  };
  LiveSession session(options, false);
  const std::atomic<bool> stop{false};
  {
    const LargestFile limit(kRoom);
    EXPECT_THROW((void)session.run(stop, observer), OperationError);
  }
  EXPECT_EQ(told.size(), 1u);
  EXPECT_GT(told_at, 0.0);
  EXPECT_NEAR(reached, 2.0, 0.05) << "the run goes on to its end";
  const ReplayResult replayed = replay({.recording = file, .scene = {}});
  EXPECT_TRUE(replayed.agree) << replayed.difference;
  EXPECT_GT(replayed.steps, 50);
  return told_at - static_cast<double>(replayed.steps) * 1e-3;
}

TEST(RecordingFaults, ALiveRunGoesOnAndWhatIsThereReplays) {
  const TemporaryDirectory directory(memory());
  EXPECT_LT(least_lost(kMayBeLostByALoop, [&] { return lost_by_a_live_run(directory / "run.db"); }),
            kMayBeLostByALoop);
}

/// Records at 1 kHz until killed after 0.9 s.
/// \returns by how much (s) what is there ends before that.
double lost_by_a_killed_recorder(const std::filesystem::path& file) {
  std::filesystem::remove(file);
  const pid_t child = ::fork();
  if (child == 0) {
    RecordingInfo info;
    info.simulation_rate = 1000.0;
    info.fingers.push_back({.name = "index", .configuration_names = {"travel_mm"}});
    StepRecord record;
    RecordingWriter writer(file, info, RecordingWriter::WhenFull::kDrop, record);
    for (;; ++record.step) {
      record.time = monotonic_time();
      writer.push(record);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  EXPECT_GT(child, 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(900));
  const double killed = monotonic_time();
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  RecordingReader reader(file);
  EXPECT_FALSE(reader.complete());
  StepRecord step;
  std::int64_t rows = 0;
  while (reader.next(step)) EXPECT_EQ(step.step, rows++) << "nothing is missing in between";
  EXPECT_GT(rows, 100);
  return killed - step.time;
}

TEST(RecordingFaults, AKillLosesAtMostTheLastFifthOfASecond) {
  const TemporaryDirectory directory(memory());
  EXPECT_LT(least_lost(kMayBeLost, [&] { return lost_by_a_killed_recorder(directory / "run.db"); }),
            kMayBeLost);
}

/// \returns by how much (s) the replay of a killed run ends before it was killed.
double lost_by_a_killed_run(const std::filesystem::path& file) {
  std::filesystem::remove(file);
  const ScenesWithoutForceLimit scenes;
  void* shared = ::mmap(nullptr, sizeof(std::atomic<double>), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) throw std::bad_alloc();
  auto& reached = *new (shared) std::atomic<double>(0.0);
  const pid_t child = ::fork();
  EXPECT_GE(child, 0);
  if (child == 0) {
    RunOptions options;
    options.scene = scenes.scene("sphere");
    options.duration = 60.0;
    options.actuator.port = "emulator";
    options.recording = file;
    const std::atomic<bool> stop{false};
    SceneRun::Hooks hooks;
    hooks.on_tick = [&](std::size_t, const FingerChain& chain) {
      reached = chain.loop().record().time;
    };
    (void)run_headless(options, stop, {}, hooks);
    ::_exit(1);  // too early
  }
  for (int i = 0; i < 6000 && reached < 0.8; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const double killed_at = reached;
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_GE(killed_at, 0.8);
  ::munmap(shared, sizeof(std::atomic<double>));
  const ReplayResult replayed = replay({.recording = file, .scene = {}});
  EXPECT_TRUE(replayed.agree) << replayed.difference;
  return killed_at - static_cast<double>(replayed.steps) * 1e-3;
}

TEST(RecordingFaults, ARunThatIsKilledReplaysUpToTheLastFifthOfASecond) {
  const TemporaryDirectory directory(memory());
  EXPECT_LT(
      least_lost(kMayBeLostByALoop, [&] { return lost_by_a_killed_run(directory / "run.db"); }),
      kMayBeLostByALoop);
}

}  // namespace
}  // namespace softfinger
