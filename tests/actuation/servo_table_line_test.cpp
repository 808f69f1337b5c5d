// Servos with control tables, from the loop over a pseudo-terminal to emulated servos.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <limits>
#include <random>
#include <thread>

#include "../support/lever_platform.hpp"
#include "softfinger/actuation/actuator.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"
#include "softfinger/motors/emulation/emulator_terminal.hpp"
#include "softfinger/motors/feetech/feetech_protocol.hpp"
#include "softfinger/motors/servo_map.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"

namespace softfinger {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr double kBusTick = 1.0 / 30.0;

bool in_time(const std::function<bool()>& done) {
  for (int i = 0; i < 2000; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(milliseconds(5));
  }
  return false;
}

std::unique_ptr<const ServoProtocol> protocol_of(const std::string& kind) {
  if (kind == "dynamixel") return std::make_unique<DynamixelProtocol>();
  return std::make_unique<FeetechProtocol>();
}

std::vector<EmulatedServo> bus_servos(const Device& device, const Configuration& q) {
  JointAngles joints;
  EXPECT_TRUE(device.inverse_kinematics(q, joints));
  std::vector<EmulatedServo> servos;
  for (const ServoSettings& settings : device.settings().transport->servos) {
    const auto joint = joints[static_cast<Eigen::Index>(servos.size())];
    servos.push_back({.channel = settings.channel,
                      .initial_setpoint = ServoMap(settings).setpoint(joint),
                      .rate = 6000.0,
                      .step = 1.0});
  }
  return servos;
}

class ServoTable : public testing::TestWithParam<const char*> {
 protected:
  std::shared_ptr<const Device> device(const std::string& port = "emulator", double rate = 30.0) {
    return lever_platform({.port = port, .rate = rate, .reversed_servo = true, .kind = GetParam()});
  }
  JointAngles joints(const ServoTableEmulator& emulator) {
    JointAngles angles(3);
    const auto lever = device();
    for (std::size_t i = 0; i < 3; ++i) {
      angles[static_cast<Eigen::Index>(i)] =
          ServoMap(lever->settings().transport->servos[i]).joint(emulator.setpoint(i));
    }
    return angles;
  }
  /// Drives until the servos stand at the pose.
  bool reaches(Actuator& actuator, const ServoTableEmulator& emulator, const Configuration& q) {
    JointAngles goal;
    EXPECT_TRUE(device()->inverse_kinematics(q, goal));
    return in_time([&] {
      actuator.command({.configuration = q, .touching = true}, time_ += kBusTick);
      std::this_thread::sleep_for(milliseconds(10));
      return (joints(emulator) - goal).cwiseAbs().maxCoeff() < 0.2 * deg;
    });
  }
  static Configuration pose(double pitch_deg, double roll_deg, double travel_mm) {
    return Eigen::Vector3d(pitch_deg * deg, roll_deg * deg, travel_mm * mm);
  }

  double time_ = 0.0;
};

TEST_P(ServoTable, EmbeddedEmulatorFollows) {
  const auto lever = device();
  Actuator actuator(lever, {});
  JointAngles goal;
  const Configuration wanted = pose(8, -4, 3);
  ASSERT_TRUE(lever->inverse_kinematics(wanted, goal));
  JointAngles now;
  EXPECT_TRUE(in_time([&] {
    actuator.command({.configuration = wanted, .touching = true}, time_ += kBusTick);
    std::this_thread::sleep_for(milliseconds(10));
    return actuator.read_servo_joints(now) && (now - goal).cwiseAbs().maxCoeff() < 0.2 * deg;
  }));
}

TEST_P(ServoTable, StartsWhereTheServosStandAndSaysWhereTheyAre) {
  const auto lever = device();
  ServoTableEmulator emulator(protocol_of(GetParam()), bus_servos(*lever, lever->retracted()));
  EmulatorTerminal terminal(emulator);
  Actuator actuator(lever, {.port = terminal.port()});
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(emulator.torque(i));
  // Torque came on, and nothing moved: a first command goes at most one tick from there.
  JointAngles retracted;
  ASSERT_TRUE(lever->inverse_kinematics(lever->retracted(), retracted));
  EXPECT_LT((joints(emulator) - retracted).cwiseAbs().maxCoeff(), 0.2 * deg);
  EXPECT_EQ(emulator.commands(), 0u);
  EXPECT_TRUE(reaches(actuator, emulator, pose(5, 5, 2)));
  JointAngles said;
  EXPECT_TRUE(in_time([&] {
    actuator.command({.configuration = pose(5, 5, 2)}, time_ += kBusTick);
    std::this_thread::sleep_for(milliseconds(10));
    return actuator.read_servo_joints(said) &&
           (said - joints(emulator)).cwiseAbs().maxCoeff() < 0.3 * deg;
  }));
  EXPECT_EQ(emulator.malformed_bytes(), 0u);
}

TEST_P(ServoTable, EveryGoalOfAHostileLiveRunIsWithinLimits) {
  const auto lever = device("emulator", 100.0);
  ServoTableEmulator emulator(protocol_of(GetParam()), bus_servos(*lever, lever->home()));
  EmulatorTerminal terminal(emulator);
  {
    Actuator actuator(lever, {.port = terminal.port()});
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const double hostile[] = {std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::infinity(), 1e30, -1e300};
    for (int k = 0; k < 250; ++k) {
      Configuration q(3);
      for (int i = 0; i < 3; ++i) q[i] = uniform(random);
      if (k % 3 == 0) q[static_cast<int>(random() % 3)] = hostile[random() % 4];
      actuator.command({.configuration = q, .tracked = k % 100 < 70}, time_ += 0.01);
      std::this_thread::sleep_for(milliseconds(random() % 9));
    }
  }
  EXPECT_GT(emulator.commands(), 30u);
  EXPECT_EQ(emulator.malformed_bytes(), 0u);
  const JointLimits& limits = lever->joint_limits();
  for (const ServoSettings& servo : lever->settings().transport->servos) {
    for (const double limit : {limits.min[0], limits.max[0]}) {
      const double end = servo.zero + servo.per_radian * limit;
      EXPECT_LT(servo.min, end);  // so that the limits that count are the joints'
      EXPECT_GT(servo.max, end);
    }
  }
  EXPECT_GE(emulator.least_goal(), 1024);    // 90 degrees reversed
  EXPECT_LE(emulator.largest_goal(), 3072);  // 90 degrees
}

TEST_P(ServoTable, ServosThatWereResetComeBackWithoutAJump) {
  const auto lever = device();
  ServoTableEmulator emulator(protocol_of(GetParam()), bus_servos(*lever, lever->home()));
  EmulatorTerminal terminal(emulator);
  Actuator actuator(lever, {.port = terminal.port()});
  ASSERT_TRUE(reaches(actuator, emulator, pose(5, 0, 2)));
  emulator.reset();
  // It notices that torque is gone, opens the bus again and goes on.
  bool lost = false;
  EXPECT_TRUE(in_time([&] {
    actuator.command({.configuration = pose(-5, 0, 3)}, time_ += kBusTick);
    std::this_thread::sleep_for(milliseconds(10));
    while (const auto event = actuator.take_event()) lost |= *event == ActuatorEvent::kPortLost;
    return lost && actuator.connected() && emulator.torque(0) && emulator.torque(2);
  }));
  EXPECT_TRUE(reaches(actuator, emulator, pose(-5, 0, 3)));
}

// What nobody speaks to any more a Dynamixel ends by itself, and a Feetech servo does not.
TEST_P(ServoTable, ItIsToldWhatTheServosDoIfTheComputerDies) {
  const auto lever = device();
  ServoTableEmulator emulator(protocol_of(GetParam()), bus_servos(*lever, lever->home()));
  EmulatorTerminal terminal(emulator);
  Actuator actuator(lever, {.port = terminal.port()});
  ASSERT_TRUE(actuator.connected());
  int told = 0;
  while (const auto event = actuator.take_event()) {
    told += *event == ActuatorEvent::kUnwatched ? 1 : 0;
    EXPECT_NE(actuator.message(*event).find("keep the last command"), std::string::npos);
  }
  EXPECT_EQ(told, emulator.table().watchdog.size == 0 ? 1 : 0);
}

TEST_P(ServoTable, PortVanishesAndComesBack) {
  const auto lever = device();
  const auto name = std::filesystem::temp_directory_path() /
                    ("softfinger-bus-" + std::to_string(::getpid()) + GetParam());
  const auto point_at = [&](const std::string& port) {
    std::filesystem::remove(name);
    std::filesystem::create_symlink(port, name);
  };
  ServoTableEmulator first(protocol_of(GetParam()), bus_servos(*lever, lever->home()));
  ServoTableEmulator second(protocol_of(GetParam()), bus_servos(*lever, lever->home()));
  auto terminal = std::make_unique<EmulatorTerminal>(first);
  point_at(terminal->port());
  Actuator actuator(lever, {.port = name.string()});
  EXPECT_TRUE(reaches(actuator, first, pose(5, 0, 2)));
  terminal->vanish();
  std::filesystem::remove(name);
  ASSERT_TRUE(in_time([&] {
    actuator.command({.configuration = pose(5, 0, 2)}, time_ += kBusTick);
    return !actuator.connected();
  }));
  terminal = std::make_unique<EmulatorTerminal>(second);
  point_at(terminal->port());
  ASSERT_TRUE(actuator.wait_until_connected(milliseconds(10000)));
  EXPECT_TRUE(reaches(actuator, second, pose(5, 0, 2)));
  std::filesystem::remove(name);
}

std::string refusal_of(const std::shared_ptr<const Device>& device, const std::string& port) {
  try {
    Actuator actuator(device, {.port = port});
  } catch (const InputError& error) {
    EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
    return error.what();
  }
  return "opened";
}

TEST_P(ServoTable, SaysWhichIdsAreSilent) {
  const auto lever = device();
  auto servos = bus_servos(*lever, lever->home());
  servos[1].channel = 9;
  ServoTableEmulator emulator(protocol_of(GetParam()), servos);
  EmulatorTerminal terminal(emulator);
  EXPECT_THAT(refusal_of(lever, terminal.port()),
              testing::AllOf(HasSubstr(terminal.port()), HasSubstr("id 3 did not answer")));
  EXPECT_FALSE(emulator.torque(0));  // nothing was begun
}

/// Answers whatever comes with bytes of its own.
class NoisyBus : public BusEmulator {
 public:
  explicit NoisyBus(unsigned bytes) : bytes_(bytes) {}
  void receive(std::span<const std::uint8_t>) override { due_ = bytes_; }
  std::size_t take_replies(std::span<std::uint8_t> out) override {
    const std::size_t size = std::min<std::size_t>(due_, out.size());
    for (std::size_t i = 0; i < size; ++i) {
      out[i] = static_cast<std::uint8_t>(i % 5 < 2 ? 0xFF : random_());
    }
    due_ = 0;
    return size;
  }
  void advance_to(double) override {}
  [[nodiscard]] double setpoint(std::size_t) const override { return 0.0; }

 private:
  unsigned bytes_;
  std::size_t due_ = 0;
  std::mt19937_64 random_{3};
};

TEST_P(ServoTable, SilenceAndNoiseAreToldApart) {
  NoisyBus silent(0);
  EmulatorTerminal nobody(silent);
  EXPECT_THAT(refusal_of(device(), nobody.port()),
              testing::AllOf(HasSubstr("no servo answers"), HasSubstr("1, 3, 5")));
  NoisyBus noisy(23);
  EmulatorTerminal noise(noisy);
  EXPECT_THAT(refusal_of(device(), noise.port()),
              testing::AllOf(HasSubstr("no valid frame"), HasSubstr("1000000 baud")));
}

/// The servos' bus with noise in between, and answers cut in half.
class BadLine : public BusEmulator {
 public:
  explicit BadLine(ServoTableEmulator& servos) : servos_(servos) {}
  void receive(std::span<const std::uint8_t> bytes) override { servos_.receive(bytes); }
  std::size_t take_replies(std::span<std::uint8_t> out) override {
    const std::size_t size = servos_.take_replies(out);
    if (!bad_ || random_() % 3 != 0) return size;
    if (random_() % 2 == 0) return size / 2;
    if (size > 0) out[random_() % size] ^= 0x40;
    return size;
  }
  void advance_to(double time) override { servos_.advance_to(time); }
  [[nodiscard]] double setpoint(std::size_t servo) const override {
    return servos_.setpoint(servo);
  }
  void spoil() { bad_ = true; }

 private:
  ServoTableEmulator& servos_;
  std::atomic<bool> bad_{false};
  std::mt19937_64 random_{29};
};

TEST_P(ServoTable, ABadLineCostsAnswersAndNothingElse) {
  const auto lever = device();
  ServoTableEmulator emulator(protocol_of(GetParam()), bus_servos(*lever, lever->home()));
  BadLine line(emulator);
  EmulatorTerminal terminal(line);
  Actuator actuator(lever, {.port = terminal.port()});
  line.spoil();
  EXPECT_TRUE(reaches(actuator, emulator, pose(6, -3, 2)));
  EXPECT_TRUE(reaches(actuator, emulator, pose(-6, 3, 4)));
  JointAngles said;
  if (actuator.read_servo_joints(said)) {
    EXPECT_LT(said.cwiseAbs().maxCoeff(), 91.0 * deg);  // no wrong byte ever became a position
  }
}

INSTANTIATE_TEST_SUITE_P(Families, ServoTable, testing::Values("dynamixel", "feetech"),
                         [](const auto& name) { return std::string(name.param); });

}  // namespace
}  // namespace softfinger
