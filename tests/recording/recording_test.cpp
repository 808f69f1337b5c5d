#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "../support/temporary_directory.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/recording/recording_writer.hpp"
#include "softfinger/recording/sqlite_database.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using WhenFull = RecordingWriter::WhenFull;

RecordingInfo one_finger() {
  RecordingInfo info;
  info.program_version = "1.2.3";
  info.instruction_set = "baseline";
  info.scene = "/somewhere/scene.toml";
  info.simulation_rate = 1000.0;
  info.fingers.push_back({.name = "index",
                          .model = "/somewhere/finger.toml",
                          .device = "/somewhere/device.toml",
                          .tracker = "script",
                          .configuration_names = {"pitch_deg", "roll_deg", "travel_mm"},
                          .joints = 3,
                          .device_rate = 30.0});
  info.files.push_back({"/somewhere/scene.toml", std::string("a\0b\n", 4)});
  return info;
}

StepRecord step_record(std::int64_t step) {
  StepRecord record;
  record.step = step;
  record.time = static_cast<double>(step) / 1000.0;
  record.tracked.X_WFt.translation = {0.1, -0.2, 1.0 / 3.0 + static_cast<double>(step)};
  record.tracked.X_WFt.rotation = Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5);
  record.tracked.time = 0.25;
  record.tracked.valid = step % 2 == 0;
  record.X_WF.translation = {1e-300, 5e300, -0.7};
  record.contact_count = static_cast<int>(step);
  record.contact_area = 1.1e-5;
  record.normal_force = 0.123456789012345678;
  record.normal_force_sum = 0.25;
  record.tangential_force = 0.5;
  record.slip_ratio = 0.75;
  record.stuck_fraction = 0.25;
  record.centroid_F = {1.0, 2.0, 3.0};
  record.mean_normal_F = {0.0, 0.6, 0.8};
  record.least_gap = std::numeric_limits<double>::infinity();
  record.iterations = 4;
  record.converged = false;
  record.residual = 1e-7;
  record.tick = step / 33;
  record.hash = 0xfedcba9876543210u + static_cast<std::uint64_t>(step);
  record.cpu_time = 1e-4;
  record.wall_time = 2e-4;
  return record;
}

TickRecord tick_record(std::int64_t tick) {
  TickRecord record;
  record.tick = tick;
  record.step = tick * 33;
  record.time = 0.033 * static_cast<double>(tick);
  record.wanted = Eigen::Vector3d(0.1, 0.2, 0.003);
  record.deviation = 1e-9;
  record.iterations = 5;
  record.command.configuration = Eigen::Vector3d(0.05, 1.0 / 3.0, -0.002);
  record.command.joints = Eigen::Vector3d(0.4, 0.5, 0.6);
  record.command.servos = 3;
  record.command.targets = {6000, 6001, 6003};
  record.command.state = DeviceState::kRendering;
  record.hash = 77;
  return record;
}

TEST(Recording, GivesBackWhatWasRecordedToTheBit) {
  const TemporaryDirectory directory;
  RecordingInfo info = one_finger();
  info.with_state = true;
  info.fingers[0].poses = "filtered, interpolated";
  StepRecord prototype = step_record(0);
  prototype.nodes_W.assign(7, Vector3(1.0, 2.0, 1.0 / 3.0));
  prototype.samples.assign(3, {Vector3(0.1, 0.2, 0.3), -1e-5, Vector3(0.0, 0.0, 1.0), 1.0});
  {
    RecordingWriter writer(directory / "run.db", info, WhenFull::kWait, prototype);
    for (std::int64_t i = 0; i < 2000; ++i) {
      StepRecord record = step_record(i);
      record.nodes_W = prototype.nodes_W;
      record.samples = prototype.samples;
      writer.push(record);
      if (i % 33 == 0) writer.push(tick_record(i / 33));
    }
    writer.close();
    EXPECT_EQ(writer.dropped(), 0u);
  }
  RecordingReader reader(directory / "run.db");
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.info().program_version, "1.2.3");
  EXPECT_EQ(reader.info().scene, info.scene);
  EXPECT_EQ(reader.info().fingers.at(0).poses, info.fingers[0].poses);
  EXPECT_EQ(reader.info().files.at(0).content, info.files[0].content);
  EXPECT_EQ(reader.info().fingers.at(0).configuration_names, info.fingers[0].configuration_names);
  EXPECT_EQ(reader.last_step(), 1999);

  StepRecord step;
  for (std::int64_t i = 0; i < 2000; ++i) {
    ASSERT_TRUE(reader.next(step));
    const StepRecord expected = step_record(i);
    EXPECT_EQ(first_difference(expected, step), nullptr);
    EXPECT_EQ(step.tracked.time, expected.tracked.time);
    EXPECT_EQ(step.tick, expected.tick);
    EXPECT_EQ(step.wall_time, expected.wall_time);
    EXPECT_EQ(step.nodes_W, prototype.nodes_W);
    ASSERT_EQ(step.samples.size(), 3u);
    EXPECT_EQ(step.samples[2].gap, -1e-5);
  }
  EXPECT_FALSE(reader.next(step));
  TickRecord tick;
  for (std::int64_t i = 0; i <= 1999 / 33; ++i) {
    ASSERT_TRUE(reader.next(tick));
    EXPECT_EQ(first_difference(tick_record(i), tick), nullptr);
  }
  EXPECT_FALSE(reader.next(tick));
}

TEST(Recording, NeverOverwritesAFile) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "run.db") << "precious";
  EXPECT_THROW(RecordingWriter(directory / "run.db", one_finger(), WhenFull::kWait, StepRecord{}),
               InputError);
  std::string content;
  std::ifstream(directory / "run.db") >> content;
  EXPECT_EQ(content, "precious");
  EXPECT_THROW(RecordingWriter(directory / "no/such/directory/run.db", one_finger(),
                               WhenFull::kWait, StepRecord{}),
               InputError);
}

TEST(Recording, IsItsOwnersAlone) {
  const TemporaryDirectory directory;
  RecordingWriter writer(directory / "run.db", one_finger(), WhenFull::kWait, step_record(0));
  for (const char* name : {"run.db", "run.db-wal"}) {
    EXPECT_EQ(fs::status(directory / name).permissions(), fs::perms{0600}) << name;
  }
  writer.close();
  EXPECT_EQ(fs::status(directory / "run.db").permissions(), fs::perms{0600});
}

TEST(Recording, LiveProducerIsNeverHeldUpAndLossesAreCounted) {
  const TemporaryDirectory directory;
  RecordingInfo info = one_finger();
  info.with_state = true;  // the smaller ring
  StepRecord record = step_record(1);
  record.nodes_W.resize(2000);
  RecordingWriter writer(directory / "run.db", info, WhenFull::kDrop, record);
  const double began = monotonic_time();
  for (std::int64_t i = 0; i < 4000; ++i) {
    record.step = i;
    writer.push(record);
  }
  EXPECT_LT(monotonic_time() - began, 1.0);
  writer.close();
  RecordingReader reader(directory / "run.db");
  std::int64_t rows = 0;
  StepRecord step;
  while (reader.next(step)) ++rows;
  EXPECT_EQ(rows + static_cast<std::int64_t>(writer.dropped()), 4000);
  EXPECT_EQ(reader.dropped(), static_cast<std::int64_t>(writer.dropped()));
}

TEST(Recording, IsReadableWhileItIsWritten) {
  const TemporaryDirectory directory;
  RecordingWriter writer(directory / "run.db", one_finger(), WhenFull::kWait, StepRecord{});
  writer.push(step_record(0));
  bool found = false;
  for (int i = 0; i < 1000 && !found; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    RecordingReader reader(directory / "run.db");
    EXPECT_FALSE(reader.complete());
    StepRecord step;
    found = reader.next(step);
  }
  EXPECT_TRUE(found);
  writer.push(step_record(1));
  writer.close();
}

class DamagedRecording : public testing::Test {
 protected:
  void SetUp() override {
    RecordingWriter writer(file_, one_finger(), WhenFull::kWait, StepRecord{});
    for (std::int64_t i = 0; i < 1000; ++i) writer.push(step_record(i));
    writer.close();
  }

  void expect_refused() {
    try {
      RecordingReader reader(file_);
      StepRecord step;
      while (reader.next(step)) {
      }
      FAIL() << "was read";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("is no recording or is damaged"));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    }
  }

  TemporaryDirectory directory_;
  fs::path file_ = directory_ / "run.db";
};

TEST_F(DamagedRecording, Truncated) {
  fs::resize_file(file_, fs::file_size(file_) / 2);
  expect_refused();
}

TEST_F(DamagedRecording, OverwrittenInside) {
  std::fstream stream(file_, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(20'000);
  stream << std::string(30'000, 'x');
  stream.close();
  expect_refused();
}

TEST_F(DamagedRecording, Text) {
  fs::remove(file_);
  std::ofstream(file_) << std::string(5000, 'a');
  expect_refused();
}

TEST_F(DamagedRecording, Empty) {
  fs::resize_file(file_, 0);
  expect_refused();
}

// What a stranger sends may be made to read for ever.
TEST_F(DamagedRecording, ATableThatIsAViewWithoutEnd) {
  SqliteDatabase database(file_, SqliteDatabase::Mode::kCreate);
  database.execute("alter table steps rename to honest");
  database.execute(
      "create view steps as with recursive endless(n) as (select 1 union all select n + 1 from "
      "endless) select honest.* from honest, endless");
  expect_refused();
}

TEST(Recording, AbsentFileIsNamed) {
  EXPECT_THROW(RecordingReader("/no/such/file.db"), InputError);
  EXPECT_THROW(RecordingReader("/"), InputError);
}

}  // namespace
}  // namespace softfinger
