#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <thread>

#include "../support/folders.hpp"
#include "program.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/motors/emulation/emulator_terminal.hpp"
#include "softfinger/motors/maestro/maestro_emulator.hpp"
#include "softfinger/motors/servo_map.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

/// A program that renders the sphere with a thimble on a pseudo-terminal of ours, as with a real
/// one: what it leaves behind when it is killed is what a wearer would be left with.
class KilledProgram : public ::testing::Test {
 protected:
  KilledProgram() {
    place.replace_line("devices/thimble-3rrs.toml", "port =", "port = \"" + terminal.port() + "\"");
  }

  std::vector<EmulatedServo> servos_at_home() const {
    std::vector<EmulatedServo> servos;
    for (const ServoSettings& settings : device->settings().transport->servos) {
      const ServoMap map(settings);
      servos.push_back({.channel = map.channel(),
                        .initial_setpoint =
                            map.setpoint(joints_of(device->home())[Eigen::Index(servos.size())])});
    }
    return servos;
  }
  JointAngles joints_of(const Configuration& q) const {
    JointAngles joints;
    EXPECT_TRUE(device->inverse_kinematics(q, joints));
    return joints;
  }
  /// The farthest of the emulated servos from where q has it, rad.
  double away_from(const Configuration& q) const {
    const JointAngles joints = joints_of(q);
    double farthest = 0.0;
    for (Eigen::Index i = 0; i < joints.size(); ++i) {
      const ServoMap map(device->settings().transport->servos[static_cast<std::size_t>(i)]);
      const double servo = map.joint(emulator.servo_pulse(map.channel()));
      farthest = std::max(farthest, std::abs(servo - joints[i]));
    }
    return farthest;
  }
  /// Of the process that has our terminal open and is not this one.
  std::optional<fs::path> owner_of_port() const {
    std::error_code ignored;
    for (const fs::directory_entry& process : fs::directory_iterator("/proc", ignored)) {
      const std::string name = process.path().filename();
      const bool is_process = std::all_of(name.begin(), name.end(), ::isdigit);
      if (!is_process || name == std::to_string(::getpid())) continue;
      for (const fs::directory_entry& file :
           fs::directory_iterator(process.path() / "fd", ignored)) {
        if (fs::read_symlink(file.path(), ignored) == terminal.port()) return process.path();
      }
    }
    return std::nullopt;
  }
  /// The program, ended by this signal in the middle of a touch.
  void expect_retracted_after(int signal) {
    RunningProgram program({"run", place.path("scenes/sphere.toml"), "--headless"});
    expect_retracted_after(signal, program);
  }
  void expect_retracted_after(int signal, RunningProgram& program) {
    ASSERT_TRUE(soon([&] { return away_from(device->home()) > 0.05; }));
    const std::optional<fs::path> guard = owner_of_port();
    ASSERT_TRUE(guard);
    for (const char* stream : {"0", "1", "2"}) {
      EXPECT_EQ(fs::read_symlink(*guard / "fd" / stream), "/dev/null");
    }
    EXPECT_GT(away_from(device->retracted()), 0.05);
    EXPECT_EQ(program.stop(signal).status, 128 + signal);
    std::this_thread::sleep_for(std::chrono::seconds(1));
    EXPECT_LT(away_from(device->retracted()), 0.01);
    // And then nothing is left that could move it.
    EXPECT_TRUE(soon([&] { return !owner_of_port(); }));
  }
  static bool soon(const std::function<bool()>& done) {
    for (int i = 0; i < 4000; ++i) {
      if (done()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }

  Workplace place;
  std::shared_ptr<const Device> device = load_device(place.path("devices/thimble-3rrs.toml"));
  MaestroEmulator emulator{servos_at_home()};
  EmulatorTerminal terminal{emulator};
};

TEST_F(KilledProgram, LeavesTheDeviceRetracted) { expect_retracted_after(SIGKILL); }

// Whoever calls the library has the guard that comes with it.
TEST_F(KilledProgram, OfSomebodyElsesLeavesTheDeviceRetracted) {
  RunningProgram program(
      {place.path("scenes/sphere.toml"), "26.5"},
      "shift; exec " + build_folder() + "/tests/c_interface/c_program_live \"$@\"");
  expect_retracted_after(SIGKILL, program);
}

// As the system ends one whose real-time thread never sleeps.
TEST_F(KilledProgram, LeavesTheDeviceRetractedWhereAThreadRanAway) {
  expect_retracted_after(SIGXCPU);
}

// What calibrates has no guard process; it retracts however it ends, but by kill -9.
TEST_F(KilledProgram, ACalibrationThatIsInterruptedRetracts) {
  for (const int signal : {SIGINT, SIGTERM}) {
    RunningProgram program({"device", "calibrate", place.path("devices/thimble-3rrs.toml"), "--out",
                            place.path("servos.toml"), "--at", "31.6,31.6,31.6", "--moved",
                            "10,10,10"});
    ASSERT_TRUE(soon([&] { return owner_of_port().has_value(); }));
    ASSERT_TRUE(soon([&] { return away_from(device->home()) < 0.01; }));
    ASSERT_TRUE(soon([&] { return away_from(device->home()) > 0.05; }));
    EXPECT_GT(away_from(device->retracted()), 0.05);
    const ProgramRun run = program.stop(signal);
    EXPECT_EQ(run.status, 1);
    EXPECT_EQ(run.errors, "softfinger: calibrate: ended before it was done; nothing written\n");
    // The emulated board may read what was sent later than it was sent.
    EXPECT_TRUE(soon([&] { return away_from(device->retracted()) < 0.02; }));
    EXPECT_FALSE(fs::exists(place.path("servos.toml")));
  }
}

TEST_F(KilledProgram, ATouchThatNobodyTellsEndsTheFitRetracted) {
  RunningProgram program({"device", "fit", place.path("devices/thimble-3rrs.toml"), "--by-touch",
                          "--finger", place.path("fingers/index.toml"), "--person",
                          place.path("anna.toml")});
  ASSERT_TRUE(soon([&] { return owner_of_port().has_value(); }));
  ASSERT_TRUE(soon([&] { return away_from(device->home()) > 0.02; })) << "it comes nearer";
  const ProgramRun run = program.stop(0);
  EXPECT_EQ(run.status, 1);
  // A machine that is too busy to command a device in time ends it as well.
  EXPECT_THAT(run.errors,
              testing::AnyOf(testing::HasSubstr("device fit: no touch was told within 1.2 mm past "
                                                "where the skin should be"),
                             testing::HasSubstr("no command for")));
  EXPECT_TRUE(soon([&] { return away_from(device->retracted()) < 0.02; }));
  EXPECT_FALSE(fs::exists(place.path("anna.toml")));
}

TEST_F(KilledProgram, SharesItsPortWithNobodyAndGivesItBack) {
  RunningProgram program({"run", place.path("scenes/sphere.toml"), "--headless"});
  ASSERT_TRUE(soon([&] { return away_from(device->home()) > 0.05; }));
  const ProgramRun second =
      run_program({"run", place.path("scenes/sphere.toml"), "--headless", "--duration-s", "1"});
  EXPECT_EQ(second.status, 2);
  EXPECT_NE(second.errors.find("another program uses it"), std::string::npos) << second.errors;
  (void)program.stop(SIGKILL);
  ASSERT_TRUE(soon([&] { return !owner_of_port(); }));
  const ProgramRun third =
      run_program({"run", place.path("scenes/sphere.toml"), "--headless", "--duration-s", "0.5"});
  EXPECT_EQ(third.status, 0) << third.errors;
}

}  // namespace
}  // namespace softfinger
