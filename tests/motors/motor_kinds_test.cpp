// Every kind of motors, whatever there are: what its row of the table promises.
#include "softfinger/motors/motor_kinds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/motors/emulation/emulated_bus.hpp"
#include "softfinger/motors/servo_map.hpp"
#include "softfinger/motors/transport_file.hpp"
#include "softfinger/motors/transport_text.hpp"

namespace softfinger {
namespace {

JointLimits three_joints(bool linear) {
  const double unit = linear ? mm : deg;
  return {.min = JointAngles::Constant(3, -2.0 * unit),
          .max = JointAngles::Constant(3, 2.0 * unit),
          .linear = linear};
}

class EveryMotorKind : public testing::TestWithParam<const MotorKind*> {
 protected:
  [[nodiscard]] TransportSettings example(bool linear) const {
    const JointLimits limits = three_joints(linear);
    const ConfigFile file("device.toml", transport_example(GetParam()->name, limits));
    return read_transport(file.root().table("transport"), limits);
  }
};

TEST_P(EveryMotorKind, IsFoundByItsName) {
  EXPECT_EQ(&motor_kind(GetParam()->name), GetParam());
  EXPECT_EQ(std::ranges::count(transport_kinds(), GetParam()->name), 1);
}

TEST_P(EveryMotorKind, ItsExampleIsReadAndWrittenAgain) {
  for (const bool linear : {false, true}) {
    const TransportSettings read = example(linear);
    EXPECT_EQ(read.kind, GetParam()->name);
    EXPECT_EQ(read.servos.size(), GetParam()->follows_travel ? 1U : 3U);
    const std::string text = transport_text(read, linear);
    const ConfigFile file("device.toml", text);
    const TransportSettings again =
        read_transport(file.root().table("transport"), three_joints(linear));
    EXPECT_EQ(transport_text(again, linear), text);
  }
}

TEST_P(EveryMotorKind, SaysWhatItsKeysMean) {
  ASSERT_FALSE(GetParam()->keys.empty());
  for (const KeyMeaning& meaning : GetParam()->keys) {
    EXPECT_EQ(transport_key_meaning(GetParam()->name, meaning.key), meaning.text);
    EXPECT_FALSE(meaning.text.empty()) << meaning.key;
  }
}

TEST_P(EveryMotorKind, ItsBusOpensItsEmulatorAndMovesIt) {
  const TransportSettings transport = example(false);
  std::vector<EmulatedServo> servos;
  std::vector<std::int32_t> targets;
  for (const ServoSettings& servo : transport.servos) {
    const double from = 0.5 * (servo.min + servo.max);
    servos.push_back(
        {.channel = servo.channel, .initial_setpoint = from, .rate = 1e9, .step = servo.step});
    targets.push_back(
        static_cast<std::int32_t>((0.25 * servo.min + 0.75 * servo.max) / servo.step));
  }
  const EmulatedBus emulated(transport, servos);
  const auto bus = make_servo_bus(transport);
  ASSERT_EQ(bus->open(emulated.port()), "");
  bool moved = false;
  for (int tries = 0; tries < 400 && !moved; ++tries) {
    ASSERT_TRUE(bus->is_open());
    bus->write(targets);
    bus->drain();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    moved = true;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const double step = transport.servos[i].step;
      moved &= std::abs(emulated.emulator().setpoint(i) / step - targets[i]) <= 1.0;
    }
  }
  EXPECT_TRUE(moved);
}

INSTANTIATE_TEST_SUITE_P(Motors, EveryMotorKind,
                         testing::ValuesIn(motor_kinds().begin(), motor_kinds().end()),
                         [](const auto& of) { return std::string(of.param->name); });

TEST(MotorKinds, ANameThatIsNoneIsRefused) {
  EXPECT_THROW((void)motor_kind("stepper"), InputError);
  TransportSettings transport;
  transport.kind = "stepper";
  EXPECT_THROW((void)make_servo_bus(transport), InputError);
}

}  // namespace
}  // namespace softfinger
