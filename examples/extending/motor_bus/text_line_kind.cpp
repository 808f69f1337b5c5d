#include "text_line_kind.hpp"

#include <array>

#include "softfinger/base/units.hpp"
#include "text_line_bus.hpp"
#include "text_line_emulator.hpp"

namespace softfinger {
namespace {

constexpr std::array kKeys{
    KeyMeaning{"pin", "of the board"},
    KeyMeaning{"zero_us", "pulse width at joint angle 0"},
    KeyMeaning{"us_per_deg", "pulse = zero_us + us_per_deg * joint angle"},
    KeyMeaning{"us_per_mm", "pulse = zero_us + us_per_mm * joint length"},
    KeyMeaning{"min_us", "shortest pulse ever sent"},
    KeyMeaning{"max_us", "longest pulse ever sent"},
};

ServoSettings read_servo(const ConfigTable& table, const std::string& slope, const JointLimits&,
                         int) {
  ServoSettings servo;
  servo.step = 1.0 * us;
  servo.channel = table.integer("pin", 0, kMostServos - 1);
  servo.zero = table.number("zero_us", Range::positive());
  servo.per_radian = read_slope(table, slope);
  servo.min = table.number("min_us", Range::positive());
  servo.max = table.number("max_us", Range::positive());
  if (servo.min >= servo.max) table.fail("min_us", "must be less than max_us");
  return servo;
}

}  // namespace

const MotorKind& text_line_kind() {
  static const MotorKind kKind{
      .name = "text_line",
      .wire = MotorKind::Wire::kSerial,
      .default_baud = 115200,
      .unit = "us",
      .unit_scale = us,
      .servo_key = "pin",
      .keys = kKeys,
      .read_servo = read_servo,
      .servo_example =
          [](const std::string& slope, int joint) {
            return "pin = " + std::to_string(joint) + "\nzero_us = 1500.0\n" + slope +
                   " = 0.1\nmin_us = 1000.0\nmax_us = 2000.0\n";
          },
      .servo_name = [](const ServoSettings& servo) { return std::to_string(servo.channel); },
      .servo_name_text =
          [](const ServoSettings& servo) {
            return "pin = " + std::to_string(servo.channel) + "\n";
          },
      .make_bus = [](const TransportSettings& transport, LineClock&) -> std::unique_ptr<ServoBus> {
        return std::make_unique<TextLineBus>(transport);
      },
      .make_emulator = [](const TransportSettings&, std::span<const EmulatedServo> servos)
          -> std::unique_ptr<BusEmulator> { return std::make_unique<TextLineEmulator>(servos); },
  };
  return kKind;
}

}  // namespace softfinger
