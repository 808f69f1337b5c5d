// The worked example of docs/extending.md: a bus of one's own, told by its row alone.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "motor_bus/text_line_bus.hpp"
#include "motor_bus/text_line_kind.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/motors/emulation/emulator_terminal.hpp"
#include "softfinger/wire/line_clock.hpp"

namespace softfinger {
namespace {

const MotorKind& kKind = text_line_kind();

ServoSettings read_servo_of(const std::string& text) {
  const ConfigFile file("device.toml", text);
  JointLimits limits;
  limits.min = JointAngles::Constant(3, -1.0);
  limits.max = JointAngles::Constant(3, 1.0);
  return kKind.read_servo(file.root(), slope_key(kKind, false), limits, 0);
}

TransportSettings three_servos() {
  TransportSettings transport;
  transport.kind = kKind.name;
  for (int joint = 0; joint < 3; ++joint) {
    transport.servos.push_back(read_servo_of(kKind.servo_example(slope_key(kKind, false), joint)));
  }
  return transport;
}

TEST(TextLineKind, ReadsItsOwnExampleAndRefusesPulsesThatCross) {
  const ServoSettings servo = read_servo_of(kKind.servo_example("us_per_deg", 2));
  EXPECT_EQ(servo.channel, 2);
  EXPECT_DOUBLE_EQ(servo.max, 2000.0 * us);
  EXPECT_NE(kKind.servo_name_text(servo).find("pin = 2"), std::string::npos);
  EXPECT_THROW((void)read_servo_of(
                   "pin = 0\nzero_us = 1500.0\nus_per_deg = 1.0\nmin_us = 2.0\nmax_us = 1.0\n"),
               InputError);
}

TEST(TextLineBus, MovesItsEmulatorAndHearsWhereItStands) {
  const TransportSettings transport = three_servos();
  std::vector<EmulatedServo> servos(3, {.initial_setpoint = 1.2e-3, .rate = 1e9, .step = 1.0 * us});
  const auto emulator = kKind.make_emulator(transport, servos);
  const EmulatorTerminal terminal(*emulator);
  const auto bus = kKind.make_bus(transport, steady_line_clock());
  ASSERT_EQ(bus->open(terminal.port()), "");
  const std::vector<std::int32_t> targets{1500, 1480, 1523};
  std::vector<std::int32_t> positions(3);
  for (int tries = 0; tries < 400 && positions != targets; ++tries) {
    ASSERT_TRUE(bus->write(targets));
    ASSERT_TRUE(bus->ask());
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    (void)bus->take_positions(positions);
  }
  EXPECT_EQ(positions, targets);
  EXPECT_NEAR(emulator->setpoint(2), 1523.0 * us, 0.6 * us);
}

TEST(TextLineBus, NothingButAWholeLineOfItsNumbersIsRead) {
  std::vector<std::int32_t> numbers(2, -1);
  EXPECT_TRUE(read_text_line("p 1500 65535", 'p', numbers));
  EXPECT_EQ(numbers, (std::vector<std::int32_t>{1500, 65535}));
  for (const char* line : {"", "p", "m 1 2", "p 1", "p 1 2 3", "p 1 2 ", "p  1 2", "p 1 65536",
                           "p 1 -2", "p 1 2x", "p 1 99999999999999999999"}) {
    EXPECT_FALSE(read_text_line(line, 'p', numbers)) << line;
  }
}

}  // namespace
}  // namespace softfinger
