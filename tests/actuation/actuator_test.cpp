#include "softfinger/actuation/actuator.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <thread>
#include <vector>

#include "../support/lever_platform.hpp"
#include "../support/maestro_terminal.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/motors/servo_map.hpp"

namespace softfinger {
namespace {

using std::chrono::milliseconds;

constexpr double kTick = 1.0 / 30.0;

bool soon(const std::function<bool()>& done, int seconds = 8) {
  for (int i = 0; i < 200 * seconds; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(milliseconds(5));
  }
  return false;
}

Configuration configuration(double pitch_deg, double roll_deg, double travel_mm) {
  Configuration q(3);
  q << pitch_deg * deg, roll_deg * deg, travel_mm * mm;
  return q;
}

WantedMotion touching(const Configuration& q) { return {.configuration = q, .touching = true}; }

JointAngles joints_of(const Device& device, const Configuration& q) {
  JointAngles joints;
  EXPECT_TRUE(device.inverse_kinematics(q, joints));
  return joints;
}

double farthest(const JointAngles& a, const JointAngles& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

/// Where the servos of an emulator on a pseudo-terminal are.
JointAngles servo_joints(const Device& device, const MaestroEmulator& emulator) {
  JointAngles joints(3);
  for (int i = 0; i < 3; ++i) {
    const ServoMap map(device.settings().transport->servos[static_cast<std::size_t>(i)]);
    joints[i] = map.joint(emulator.servo_pulse(map.channel()));
  }
  return joints;
}

std::vector<EmulatedServo> servos_at(const Device& device, const Configuration& q) {
  const JointAngles joints = joints_of(device, q);
  std::vector<EmulatedServo> servos;
  for (int i = 0; i < 3; ++i) {
    const ServoMap map(device.settings().transport->servos[static_cast<std::size_t>(i)]);
    servos.push_back({.channel = map.channel(), .initial_setpoint = map.setpoint(joints[i])});
  }
  return servos;
}

/// A name in the file system that can be pointed at one terminal after another, like the stable
/// names of USB adapters.
class PortName {
 public:
  PortName() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("softfinger-port-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
  }
  ~PortName() { remove(); }
  void point_at(const std::string& port) {
    remove();
    std::filesystem::create_symlink(port, path_);
  }
  void remove() { std::filesystem::remove(path_); }
  [[nodiscard]] std::string name() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TEST(ActuatorInSimulatedTime, FollowsRepeatsRetractsAndStops) {
  const auto device = lever_platform();
  Actuator actuator(device, {.simulated_time = true});
  EXPECT_EQ(actuator.port(), "emulator");
  EXPECT_TRUE(actuator.connected());
  const Configuration wanted = configuration(8, -4, 3);
  for (int k = 0; k < 60; ++k) {
    const FormedCommand& command = actuator.command(touching(wanted), k * kTick);
    if (k > 20) {
      EXPECT_EQ(command.configuration, wanted);
      EXPECT_EQ(command.state, DeviceState::kRendering);
    }
  }
  EXPECT_EQ(actuator.commands_sent(), 60u);
  JointAngles servos;
  ASSERT_TRUE(actuator.read_servo_joints(servos));
  EXPECT_LT(farthest(servos, joints_of(*device, wanted)), 0.1 * deg);

  actuator.finish();
  EXPECT_TRUE(actuator.finished());
  EXPECT_EQ(actuator.state(), DeviceState::kStopped);
  EXPECT_EQ(actuator.last_command().configuration, device->retracted());
  ASSERT_TRUE(actuator.read_servo_joints(servos));
  EXPECT_LT(farthest(servos, joints_of(*device, device->retracted())), 0.1 * deg);
  // The way back takes some ticks, then nine repeat the retracted pose.
  const double way = farthest(joints_of(*device, wanted), joints_of(*device, device->retracted()));
  const double ticks = way / (400 * deg * kTick);
  EXPECT_NEAR(static_cast<double>(actuator.commands_sent()), 60 + std::ceil(ticks) + 9, 1.0);
  const auto sent = actuator.commands_sent();
  actuator.command(touching(wanted), 10.0);
  EXPECT_EQ(actuator.commands_sent(), sent);
}

TEST(ActuatorInSimulatedTime, TellsThatItIsStillOnItsWay) {
  const auto device = lever_platform();
  Actuator actuator(device, {.simulated_time = true});
  const auto at = [&](const Configuration& wanted, int tick) -> const FormedCommand& {
    return actuator.command(touching(wanted), tick * 0.02);
  };
  for (int k = 0; k < 60; ++k) at(device->home(), k);
  EXPECT_FALSE(at(device->home(), 60).rate_limited);
  const Configuration wanted = configuration(8, -4, 3);
  int late = 0;
  for (int k = 61; k < 120; ++k) {
    const FormedCommand& formed = at(wanted, k);
    late += formed.rate_limited ? 1 : 0;
    EXPECT_EQ(formed.rate_limited, formed.configuration != wanted) << k;
  }
  EXPECT_GT(late, 0);
  EXPECT_LT(late, 40);
}

TEST(ActuatorInSimulatedTime, RepeatsBitForBit) {
  const auto device = lever_platform();
  std::vector<JointAngles> first;
  for (int run = 0; run < 2; ++run) {
    Actuator actuator(device, {.simulated_time = true});
    for (int k = 0; k < 200; ++k) {
      const Configuration wanted = configuration(20 * std::sin(0.3 * k), 10 * std::cos(k), 5);
      actuator.command({.configuration = wanted, .tracked = k % 50 < 40}, k * kTick);
      JointAngles servos;
      ASSERT_TRUE(actuator.read_servo_joints(servos));
      if (run == 0) {
        first.push_back(servos);
      } else {
        EXPECT_EQ(servos, first[static_cast<std::size_t>(k)]);
      }
    }
  }
}

TEST(ActuatorInSimulatedTime, LostTrackingHoldsThenRetracts) {
  const auto device = lever_platform();
  Actuator actuator(device, {.simulated_time = true});
  int k = 0;
  for (; k < 30; ++k) actuator.command(touching(configuration(5, 5, 2)), k * kTick);
  const Configuration held = actuator.last_command().configuration;
  const double lost = k * kTick;
  for (; k * kTick - lost < 0.2 - 1e-6; ++k) {
    const auto& command =
        actuator.command({.configuration = configuration(-20, 0, 0), .tracked = false}, k * kTick);
    EXPECT_EQ(command.state, DeviceState::kHolding);
    EXPECT_EQ(command.configuration, held);
  }
  for (int end = k + 15; k < end; ++k) {
    const auto& command = actuator.command({.configuration = held, .tracked = false}, k * kTick);
    EXPECT_EQ(command.state, DeviceState::kRetracting);
  }
  EXPECT_EQ(actuator.last_command().configuration, device->retracted());
  const JointAngles before = actuator.last_command().joints;
  const auto& command = actuator.command(touching(held), k * kTick);
  EXPECT_EQ(command.state, DeviceState::kHoming);
  EXPECT_LE(farthest(command.joints, before), 400 * deg * kTick);
}

TEST(ActuatorInSimulatedTime, TimesThatAreNoTimesMoveNothing) {
  const auto device = lever_platform();
  Actuator actuator(device, {.simulated_time = true});
  for (int k = 0; k < 5; ++k) actuator.command(touching(configuration(0, 0, 2)), k * kTick);
  const JointAngles before = actuator.last_command().joints;
  for (const double time : {std::numeric_limits<double>::quiet_NaN(), -1.0,
                            std::numeric_limits<double>::infinity(), 4 * kTick}) {
    actuator.command(touching(configuration(10, 0, 2)), time);
    EXPECT_EQ(actuator.last_command().joints, before);
  }
  // A late tick allows no more motion than one tick does.
  actuator.command(touching(configuration(10, 0, -15)), 1000.0);
  EXPECT_LE(farthest(actuator.last_command().joints, before), 400 * deg * kTick);
}

/// Gives commands at the device's rate for a while.
void drive(Actuator& actuator, const Configuration& wanted, double duration) {
  const auto start = std::chrono::steady_clock::now();
  static double first = 0.0;  // run times of one test after another only grow
  first += 10.0;
  for (int k = 0; k * kTick < duration; ++k) {
    std::this_thread::sleep_until(start + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                              std::chrono::duration<double>(k * kTick)));
    actuator.command(touching(wanted), first + k * kTick);
  }
}

TEST(ActuatorInWallTime, EmbeddedEmulatorFollowsOverItsPseudoTerminal) {
  const auto device = lever_platform();
  Actuator actuator(device, {});
  EXPECT_TRUE(actuator.connected());
  const Configuration wanted = configuration(8, -4, 3);
  drive(actuator, wanted, 1.0);
  JointAngles servos;
  double later = 1e6;
  EXPECT_TRUE(soon([&] {
    actuator.command(touching(wanted), later += kTick);
    return actuator.read_servo_joints(servos) &&
           farthest(servos, joints_of(*device, wanted)) < 0.1 * deg;
  }));
  EXPECT_GE(actuator.commands_sent(), 15u);
  actuator.finish();
  EXPECT_EQ(actuator.state(), DeviceState::kStopped);
  EXPECT_TRUE(soon([&] {
    return actuator.read_servo_joints(servos) &&
           farthest(servos, joints_of(*device, device->retracted())) < 0.1 * deg;
  }));
}

TEST(ActuatorInWallTime, SendsNothingBeforeTheFirstCommand) {
  const auto device = lever_platform();
  MaestroTerminal terminal(servos_at(*device, device->home()));
  {
    Actuator actuator(device, {.port = terminal.port()});
    std::this_thread::sleep_for(milliseconds(200));
  }
  EXPECT_EQ(terminal.emulator().targets_set(), 0u);
}

TEST(ActuatorInWallTime, RetractsByItselfWhenTheLoopStalls) {
  const auto device = lever_platform();
  MaestroTerminal terminal(servos_at(*device, device->home()));
  Actuator actuator(device, {.port = terminal.port()});
  const Configuration wanted = configuration(5, 0, 4);
  drive(actuator, wanted, 0.5);
  // The loop hangs: no command() any more.
  EXPECT_TRUE(soon([&] {
    return farthest(servo_joints(*device, terminal.emulator()),
                    joints_of(*device, device->retracted())) < 0.1 * deg;
  }));
  EXPECT_EQ(actuator.state(), DeviceState::kRetracting);
  const auto event = actuator.take_event();
  ASSERT_TRUE(event);
  EXPECT_EQ(*event, ActuatorEvent::kLoopStalled);
  // And goes on where it was when the loop comes back.
  drive(actuator, wanted, 0.7);
  EXPECT_TRUE(actuator.state() == DeviceState::kRendering ||
              actuator.state() == DeviceState::kHoming);
  EXPECT_EQ(terminal.emulator().malformed_bytes(), 0u);
}

TEST(ActuatorInWallTime, StartsFromWhereTheMaestroSaysTheServosAre) {
  const auto device = lever_platform();
  MaestroTerminal terminal(servos_at(*device, device->retracted()));
  Actuator actuator(device, {.port = terminal.port()});
  actuator.command(touching(device->home()), 0.0);
  ASSERT_TRUE(soon([&] { return actuator.commands_sent() > 0; }));
  // One tick's travel from the retracted pose at most, not a jump to home.
  JointAngles servos;
  ASSERT_TRUE(actuator.read_servo_joints(servos));
  EXPECT_LT(farthest(servos, joints_of(*device, device->retracted())), 0.1 * deg);
  EXPECT_TRUE(soon([&] {
    JointAngles reported;
    return actuator.read_servo_joints(reported);
  }));
}

TEST(ActuatorInWallTime, PortVanishesAndComesBack) {
  const auto device = lever_platform();
  PortName name;
  auto terminal = std::make_unique<MaestroTerminal>(servos_at(*device, device->home()));
  name.point_at(terminal->port());
  Actuator actuator(device, {.port = name.name()});
  const Configuration wanted = configuration(5, 0, 4);
  drive(actuator, wanted, 0.3);
  EXPECT_GT(actuator.commands_sent(), 0u);

  terminal->vanish();
  name.remove();
  drive(actuator, wanted, 0.3);
  ASSERT_TRUE(soon([&] { return !actuator.connected(); }));
  EXPECT_EQ(actuator.state(), DeviceState::kDisconnected);
  // The run goes on: commands are formed as before.
  EXPECT_EQ(actuator.command(touching(wanted), 1e6).configuration, wanted);
  std::vector<ActuatorEvent> events;
  while (const auto event = actuator.take_event()) events.push_back(*event);
  EXPECT_EQ(std::count(events.begin(), events.end(), ActuatorEvent::kPortLost), 1);
  EXPECT_NE(actuator.message(ActuatorEvent::kPortLost).find(name.name()), std::string::npos);

  terminal = std::make_unique<MaestroTerminal>(servos_at(*device, device->home()));
  name.point_at(terminal->port());
  ASSERT_TRUE(actuator.wait_until_connected(milliseconds(8000)));
  drive(actuator, wanted, 0.8);
  double later = 2e6;
  EXPECT_TRUE(soon([&] {
    actuator.command(touching(wanted), later += kTick);
    return farthest(servo_joints(*device, terminal->emulator()), joints_of(*device, wanted)) <
           0.2 * deg;
  }));
  events.clear();
  while (const auto event = actuator.take_event()) events.push_back(*event);
  EXPECT_EQ(std::count(events.begin(), events.end(), ActuatorEvent::kPortConnected), 1);
  EXPECT_EQ(std::count(events.begin(), events.end(), ActuatorEvent::kPortLost), 0);
  EXPECT_EQ(terminal->emulator().malformed_bytes(), 0u);
}

TEST(ActuatorInWallTime, AtTheEndItRepeatsTheRetractedPoseThenIsSilent) {
  const auto device = lever_platform();
  MaestroTerminal terminal(servos_at(*device, device->home()));
  Actuator actuator(device, {.port = terminal.port()});
  drive(actuator, configuration(0, 0, 2), 0.3);
  const auto before = actuator.commands_sent();
  const auto start = std::chrono::steady_clock::now();
  actuator.finish();
  const auto took = std::chrono::steady_clock::now() - start;
  EXPECT_GE(took, milliseconds(300));
  EXPECT_LT(took, milliseconds(3000));
  EXPECT_GE(actuator.commands_sent(), before + 5);
  const JointAngles retracted = joints_of(*device, device->retracted());
  ASSERT_TRUE(soon(
      [&] { return farthest(servo_joints(*device, terminal.emulator()), retracted) < 0.1 * deg; }));
  ASSERT_TRUE(
      soon([&] { return terminal.emulator().targets_set() == 3 * actuator.commands_sent(); }));
  const auto bytes = terminal.emulator().bytes();
  std::this_thread::sleep_for(milliseconds(200));
  EXPECT_EQ(terminal.emulator().bytes(), bytes);
}

TEST(ActuatorInWallTime, ARealPortIsServedAtItsOwnRateInAnUnpacedRun) {
  const auto device = lever_platform();
  MaestroTerminal terminal(servos_at(*device, device->home()));
  Actuator actuator(device, {.port = terminal.port(), .simulated_time = true});
  const auto start = std::chrono::steady_clock::now();
  int k = 0;
  while (std::chrono::steady_clock::now() - start < milliseconds(500)) {
    actuator.command(touching(configuration(0, 0, k % 2)), kTick * k);
    ++k;
  }
  EXPECT_GT(k, 100);
  EXPECT_LE(actuator.commands_sent(), 17u);
}

TEST(ActuatorPort, AbsentAtTheStart) {
  try {
    Actuator actuator(lever_platform({.port = "/dev/no-such-port"}), {});
    FAIL() << "opened a port that is not there";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("/dev/no-such-port"), std::string::npos) << text;
    EXPECT_NE(text.find("there is no such port"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

TEST(ActuatorPort, AbsentAtTheStartNamesFileAndKey) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("softfinger-device-" + std::to_string(::getpid()) + ".toml");
  std::ofstream(file) << "kind = \"x\"\n[transport]\nport = \"/dev/no-such-port\"\n";
  try {
    Actuator actuator(lever_platform({.port = "/dev/no-such-port"}), {.device_file = file});
    FAIL() << "opened a port that is not there";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find(file.string() + ":3"), std::string::npos) << text;
    EXPECT_NE(text.find("port"), std::string::npos) << text;
  }
  std::filesystem::remove(file);
}

TEST(ActuatorPort, MayBeWaitedFor) {
  const auto device = lever_platform();
  PortName name;
  Actuator actuator(device, {.port = name.name(), .wait_for_device = true});
  EXPECT_FALSE(actuator.connected());
  EXPECT_EQ(actuator.state(), DeviceState::kDisconnected);
  EXPECT_FALSE(actuator.wait_until_connected(milliseconds(20)));
  MaestroTerminal terminal(servos_at(*device, device->home()));
  name.point_at(terminal.port());
  EXPECT_TRUE(actuator.wait_until_connected(milliseconds(8000)));
  drive(actuator, configuration(0, 0, 2), 0.3);
  EXPECT_TRUE(soon([&] { return terminal.emulator().targets_set() > 0; }));
}

}  // namespace
}  // namespace softfinger
