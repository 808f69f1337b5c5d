// Limits of speed that the hardware keeps, whatever it is sent: from the joints' rates in a device
// file to how fast the servos of each bus can move at most.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"
#include "softfinger/motors/emulation/emulator_terminal.hpp"
#include "softfinger/motors/feetech/feetech_protocol.hpp"
#include "softfinger/motors/motor_kinds.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"
#include "softfinger/motors/transport_file.hpp"

namespace softfinger {
namespace {

JointLimits limits_of(double rate, double acceleration) {
  return {.min = JointAngles::Constant(1, -20.0 * deg),
          .max = JointAngles::Constant(1, 60.0 * deg),
          .max_rate = rate,
          .max_acceleration = acceleration};
}

TransportSettings settings_of(const std::string& kind, const JointLimits& limits) {
  const std::string slope = kind == "maestro" ? "us_per_deg = 10.0" : "ticks_per_deg = 11.3778";
  const std::string servo =
      kind == "maestro" ? "channel = 3\nzero_us = 1500.0\nmin_us = 900.0\nmax_us = 2400.0\n"
                        : "id = 3\nzero_ticks = 2048.0\nmin_ticks = 1500\nmax_ticks = 3500\n";
  const ConfigFile file("memory.toml", "[transport]\nkind = \"" + kind +
                                           "\"\n[[transport.servo]]\n" + servo + slope + "\n");
  return read_transport(file.root().table("transport"), limits);
}

class MotorLimits : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Buses, MotorLimits, testing::Values("maestro", "dynamixel", "feetech"),
                         [](const auto& name) { return std::string(name.param); });

TEST_P(MotorLimits, AreSomewhatAboveThoseOfTheJoints) {
  const JointLimits limits = limits_of(400.0 * deg, 8000.0 * deg);
  const ServoSettings servo = settings_of(GetParam(), limits).servos.front();
  EXPECT_NEAR(servo.max_rate, 1.25 * limits.max_rate * std::abs(servo.per_radian), 1e-9);
  EXPECT_NEAR(servo.max_acceleration, 1.25 * limits.max_acceleration * std::abs(servo.per_radian),
              1e-6);
  const JointLimits free = limits_of(400.0 * deg, std::numeric_limits<double>::infinity());
  EXPECT_EQ(settings_of(GetParam(), free).servos.front().max_acceleration, 0.0);
}

TEST_P(MotorLimits, OfJointsThatMayGetFasterAtOnceAreOfSpeedAlone) {
  const JointLimits free = limits_of(400.0 * deg, std::numeric_limits<double>::infinity());
  const TransportSettings settings = settings_of(GetParam(), free);
  EXPECT_GT(settings.servos.front().max_rate, 0.0);
  EXPECT_NE(motor_kind(GetParam()).make_bus(settings, steady_line_clock()), nullptr);
  const TransportSettings gentle = settings_of(GetParam(), limits_of(400.0 * deg, 8000.0 * deg));
  EXPECT_GT(gentle.servos.front().max_acceleration, 0.0);
  EXPECT_NE(motor_kind(GetParam()).make_bus(gentle, steady_line_clock()), nullptr);
}

TEST_P(MotorLimits, RangesThatAreNoneAreRefusedWithTheKey) {
  const bool maestro = std::string(GetParam()) == "maestro";
  const auto refusal = [&](const std::string& servo) -> std::string {
    const ConfigFile file("device.toml", std::string("[transport]\nkind = \"") + GetParam() +
                                             "\"\n[[transport.servo]]\n" + servo);
    try {
      (void)read_transport(file.root().table("transport"), limits_of(1.0, 1.0));
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  const std::string head = maestro ? "channel = 3\nzero_us = 1500.0\nus_per_deg = 10.0\n"
                                   : "id = 3\nzero_ticks = 2048.0\nticks_per_deg = 11.3778\n";
  const std::string unit = maestro ? "_us" : "_ticks";
  const auto range = [&](const std::string& min, const std::string& max) {
    return refusal(head + "min" + unit + " = " + min + "\nmax" + unit + " = " + max + "\n");
  };
  const std::string dot = maestro ? ".0" : "";
  EXPECT_EQ(range("900" + dot, "3000" + dot), "");
  EXPECT_NE(range("2000" + dot, "2000" + dot).find("min" + unit), std::string::npos);
  EXPECT_NE(range("2001" + dot, "2000" + dot).find("less than max"), std::string::npos);
  EXPECT_NE(range("900" + dot, "4097" + dot).find("max" + unit), std::string::npos);
}

// A goal far away, as if nothing in the program bounded it: the servo takes the time that its limit
// says, though it could be ten times as fast.
TEST_P(MotorLimits, HoldTheServoWhateverItIsSent) {
  const double rate = 100.0 * deg;
  const TransportSettings settings =
      settings_of(GetParam(), limits_of(rate, std::numeric_limits<double>::infinity()));
  const ServoSettings& servo = settings.servos.front();
  const double slope = std::abs(servo.per_radian);
  const std::array servos{EmulatedServo{.channel = 3,
                                        .initial_setpoint = servo.zero,
                                        .rate = 10.0 * rate * slope,
                                        .step = servo.step}};
  const auto emulator = motor_kind(settings.kind).make_emulator(settings, servos);
  const EmulatorTerminal terminal(*emulator);
  const auto bus = make_servo_bus(settings);
  ASSERT_EQ(bus->open(terminal.port()), "");
  const auto send = [&](double joint) {
    const std::array target{static_cast<std::int32_t>(
        std::lround((servo.zero + servo.per_radian * joint) / servo.step))};
    return bus->write(target);
  };
  // To where it stands first: a Maestro's channel without pulses knows no way.
  ASSERT_TRUE(send(0.0));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto began = std::chrono::steady_clock::now();
  ASSERT_TRUE(send(50.0 * deg));
  double joint = 0.0;
  double fastest = 0.0;
  while (joint < 45.0 * deg) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    joint = (emulator->setpoint(0) - servo.zero) / servo.per_radian;
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - began;
    fastest = std::max(fastest, joint / time.count());
    ASSERT_LT(time.count(), 10.0) << joint;
  }
  EXPECT_LE(fastest, 1.3 * rate);
  EXPECT_GE(fastest, 0.5 * rate) << "held back by more than its limit";
}

// A servo that does not keep what was written is no servo to turn the torque of on.
TEST(MotorLimits, AreReadBack) {
  const TransportSettings settings =
      settings_of("feetech", limits_of(400.0 * deg, std::numeric_limits<double>::infinity()));
  const std::array servos{EmulatedServo{.channel = 3, .initial_setpoint = 2048.0, .step = 1.0}};
  ServoTableEmulator emulator(std::make_unique<FeetechProtocol>(), servos);
  emulator.forget(feetech::kSpeed);
  const EmulatorTerminal terminal(emulator);
  const auto bus = make_servo_bus(settings);
  EXPECT_EQ(bus->open(terminal.port()),
            "servo 3 does not keep 3400 at address 46 of its control table");
  EXPECT_FALSE(bus->is_open());
  EXPECT_FALSE(emulator.torque(0));
}

}  // namespace
}  // namespace softfinger
