#include "softfinger/motors/maestro/maestro_kind.hpp"

#include <fmt/core.h>

#include <array>

#include "softfinger/base/units.hpp"
#include "softfinger/motors/maestro/maestro_bus.hpp"
#include "softfinger/motors/maestro/maestro_emulator.hpp"

namespace softfinger {
namespace {

constexpr std::array kMaestroKeys{
    KeyMeaning{"channel", "of the Maestro"},
    KeyMeaning{"zero_us", "pulse width at joint angle 0"},
    KeyMeaning{"us_per_deg", "pulse = zero_us + us_per_deg * joint angle"},
    KeyMeaning{"us_per_mm", "pulse = zero_us + us_per_mm * joint length"},
    KeyMeaning{"min_us", "shortest pulse ever sent"},
    KeyMeaning{"max_us", "longest pulse ever sent"},
};

ServoSettings read_maestro_servo(const ConfigTable& table, const std::string& slope,
                                 const JointLimits&, int) {
  ServoSettings servo;
  servo.channel = table.integer("channel", 0, kMostServos - 1);
  servo.zero = table.number("zero_us", Range::positive());
  servo.per_radian = read_slope(table, slope);
  servo.min = table.number("min_us", Range::positive());
  servo.max = table.number("max_us", Range::positive());
  if (servo.min >= servo.max) table.fail("min_us", "must be less than max_us");
  // The Maestro's targets are 14-bit quarters of a microsecond.
  if (servo.max > 4095.75 * us) table.fail("max_us", "must be at most 4095.75, the longest pulse");
  return servo;
}

}  // namespace

const MotorKind& maestro_kind() {
  static const MotorKind kKind{
      .name = "maestro",
      .wire = MotorKind::Wire::kSerial,
      .default_baud = 115200,
      .unit = "us",
      .unit_scale = us,
      .left_alone =
          "its servos keep the last command if this computer dies, unless the Maestro has "
          "a serial timeout",
      .has_torque = true,
      .servo_key = "channel",
      .keys = kMaestroKeys,
      .read_servo = read_maestro_servo,
      .servo_example =
          [](const std::string& slope, int joint) {
            return fmt::format(
                "channel = {}\nzero_us = 1500.0\n{} = 0.1\nmin_us = 1000.0\nmax_us = 2000.0\n",
                joint, slope);
          },
      .servo_name = [](const ServoSettings& servo) { return std::to_string(servo.channel); },
      .servo_name_text =
          [](const ServoSettings& servo) { return fmt::format("channel = {}\n", servo.channel); },
      .make_bus = [](const TransportSettings& transport, LineClock&) -> std::unique_ptr<ServoBus> {
        return std::make_unique<MaestroBus>(transport);
      },
      .make_emulator = [](const TransportSettings&, std::span<const EmulatedServo> servos)
          -> std::unique_ptr<BusEmulator> { return std::make_unique<MaestroEmulator>(servos); },
  };
  return kKind;
}

}  // namespace softfinger
