#include "softfinger/motors/servo_table/servo_table_bus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"
#include "softfinger/motors/emulation/emulator_terminal.hpp"
#include "softfinger/motors/servo_bus.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;

TEST(SerialBus, RefusesMoreThanTheLineCarries) {
  // What a tick needs, ms, by the bytes that each says.
  for (const auto& [kind, needs] : {std::pair("maestro", "19.8"), std::pair("dynamixel", "80.2"),
                                    std::pair("feetech", "42.7")}) {
    TransportSettings transport;
    transport.kind = kind;
    transport.baud = 9600;
    for (int channel = 1; channel <= 2; ++channel) {
      transport.servos.push_back({.channel = channel, .step = 1.0});
    }
    transport.rate = 10.0;
    EXPECT_NE(make_servo_bus(transport), nullptr) << kind;
    transport.rate = 100.0;
    try {
      static_cast<void>(make_servo_bus(transport));
      FAIL() << kind;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(),
                  HasSubstr("transport.rate_Hz: 100 ticks a second leave 10 ms each, but 2 servos "
                            "at 9600 baud need " +
                            std::string(needs) + " ms"));
    }
  }
}

TEST(DynamixelBus, WritesLimitsIntoTheServos) {
  TransportSettings transport;
  transport.kind = "dynamixel";
  transport.baud = 1000000;
  transport.servos.push_back(
      {.channel = 7, .min = 1000.0, .max = 3000.0, .step = 1.0, .current_limit = 120});
  const std::array<EmulatedServo, 1> servos{
      EmulatedServo{.channel = 7, .initial_setpoint = 2000.0, .rate = 4000.0, .step = 1.0}};
  ServoTableEmulator emulator(std::make_unique<DynamixelProtocol>(), servos);
  auto terminal = std::make_unique<EmulatorTerminal>(emulator);
  const auto bus = make_servo_bus(transport);
  ASSERT_EQ(bus->open(terminal->port()), "");
  bus->close();
  terminal->vanish();  // now the servo is still
  EXPECT_EQ(emulator.value(0, dynamixel::kOperatingMode), dynamixel::kCurrentBasedPositionMode);
  EXPECT_EQ(emulator.value(0, dynamixel::kMinPosition), 1000u);
  EXPECT_EQ(emulator.value(0, dynamixel::kMaxPosition), 3000u);
  EXPECT_EQ(emulator.value(0, dynamixel::kCurrentLimit), 120u);
  EXPECT_EQ(emulator.value(0, dynamixel::kGoalCurrent), 120u);
  EXPECT_EQ(emulator.goal(0), 2000);
  EXPECT_TRUE(emulator.torque(0));
  // What is right already is not written again: that memory wears out.
  const auto writes = emulator.lasting_writes();
  EXPECT_GT(writes, 0u);
  terminal = std::make_unique<EmulatorTerminal>(emulator);
  ASSERT_EQ(bus->open(terminal->port()), "");
  EXPECT_EQ(emulator.lasting_writes(), writes);
}

}  // namespace
}  // namespace softfinger
