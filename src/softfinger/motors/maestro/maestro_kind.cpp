#include "softfinger/motors/maestro/maestro_kind.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "softfinger/base/units.hpp"
#include "softfinger/motors/maestro/maestro_bus.hpp"
#include "softfinger/motors/maestro/maestro_emulator.hpp"

namespace softfinger {
namespace {

/// A board that hears nothing for so many ticks hears nobody.
constexpr double kLeastTimeoutTicks = 5.0;

constexpr std::array kMaestroLineKeys{
    KeyMeaning{"crc", "true: commands have checksums, as the board's CRC mode asks for"},
    KeyMeaning{"serial_timeout_ms",
               "the board's own: after such a silence it takes its servos home; 0: not relied on"},
};

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

void read_maestro_line(const ConfigTable& table, TransportSettings& transport) {
  transport.crc = table.boolean("crc", false);
  transport.serial_timeout = table.number("serial_timeout_ms", Range::between(0.0, 2000.0), 0.0);
  const double least = std::max(kLeastTimeoutTicks / transport.rate, 20.0 * ms);
  if (transport.serial_timeout <= 0.0 || transport.serial_timeout >= least) return;
  table.fail("serial_timeout_ms",
             fmt::format("{:g} is less than {:g}, {:g} ticks at this rate_Hz; a longer one must "
                         "be set here and in the board",
                         transport.serial_timeout / ms, least / ms, kLeastTimeoutTicks));
}

std::string maestro_line_text(const TransportSettings& transport) {
  std::string text;
  if (transport.crc) text += "crc = true\n";
  if (transport.serial_timeout > 0.0) {
    text += fmt::format("serial_timeout_ms = {:g}\n", transport.serial_timeout / ms);
  }
  return text;
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
          "a serial timeout (serial_timeout_ms)",
      .is_watched =
          [](const TransportSettings& transport) { return transport.serial_timeout > 0.0; },
      .has_torque = true,
      .servo_key = "channel",
      .line_keys = kMaestroLineKeys,
      .keys = kMaestroKeys,
      .read_line = read_maestro_line,
      .line_text = maestro_line_text,
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
      .make_bus = [](const TransportSettings& transport, LineClock& clock)
          -> std::unique_ptr<ServoBus> { return std::make_unique<MaestroBus>(transport, clock); },
      .make_emulator = [](const TransportSettings& transport,
                          std::span<const EmulatedServo> servos) -> std::unique_ptr<BusEmulator> {
        return std::make_unique<MaestroEmulator>(servos, maestro_board(transport));
      },
  };
  return kKind;
}

}  // namespace softfinger
