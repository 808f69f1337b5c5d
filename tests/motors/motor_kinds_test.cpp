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
  /// In the middle of their set points, and as quick as they like.
  static std::vector<EmulatedServo> servos_of(const TransportSettings& transport) {
    std::vector<EmulatedServo> servos;
    for (const ServoSettings& servo : transport.servos) {
      servos.push_back({.channel = servo.channel,
                        .initial_setpoint = 0.5 * (servo.min + servo.max),
                        .rate = 1e9,
                        .step = servo.step});
    }
    return servos;
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
  std::vector<std::int32_t> targets;
  for (const ServoSettings& servo : transport.servos) {
    targets.push_back(
        static_cast<std::int32_t>((0.25 * servo.min + 0.75 * servo.max) / servo.step));
  }
  const EmulatedBus emulated(transport, servos_of(transport));
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

TEST_P(EveryMotorKind, LetsGoWhereItsFileMaySaySo) {
  std::string text = transport_example(GetParam()->name, three_joints(false));
  text.insert(text.find("[[transport.servo]]"), "at_end = \"torque_off\"\n");
  const ConfigFile file("device.toml", text);
  TransportSettings read;
  const auto read_it = [&] {
    read = read_transport(file.root().table("transport"), three_joints(false));
  };
  if (!GetParam()->has_torque) {
    try {
      read_it();
      FAIL() << "its servos would be held all the same";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("device.toml:3: transport.at_end"));
    }
    return;
  }
  read_it();
  EXPECT_TRUE(read.limp_at_end);
  EXPECT_THAT(transport_text(read, false), testing::HasSubstr("at_end = \"torque_off\"\n"));
  const EmulatedBus emulated(read, servos_of(read));
  const auto bus = make_servo_bus(read);
  ASSERT_EQ(bus->open(emulated.port()), "");
  EXPECT_TRUE(bus->let_go());
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
