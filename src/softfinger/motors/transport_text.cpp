#include "softfinger/motors/transport_text.hpp"

#include <fmt/format.h>

#include "softfinger/base/units.hpp"
#include "softfinger/motors/motor_kinds.hpp"

namespace softfinger {
namespace {

/// A number that TOML takes as a float.
std::string float_text(double value) { return fmt::format("{:#.9g}", value); }

/// As TOML has text.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

}  // namespace

std::string transport_text(const TransportSettings& transport, bool linear_joints) {
  const MotorKind& kind = motor_kind(transport.kind);
  const double unit = kind.unit_scale;
  const double slope_unit = unit / (linear_joints || kind.follows_travel ? mm : deg);
  std::string text =
      fmt::format("[transport]\nkind = \"{}\"\nport = {}\n", kind.name, quoted(transport.port));
  if (kind.wire == MotorKind::Wire::kSerial) text += fmt::format("baud = {}\n", transport.baud);
  text += fmt::format("rate_Hz = {}\n", float_text(transport.rate));
  if (transport.limp_at_end) text += "at_end = \"torque_off\"\n";
  if (kind.line_text != nullptr) text += kind.line_text(transport);
  for (const ServoSettings& servo : transport.servos) {
    text += "\n[[transport.servo]]\n" + kind.servo_name_text(servo);
    text += fmt::format("{} = {}\n{} = {}\n", key_with_unit(kind, "zero"),
                        float_text(servo.zero / unit), slope_key(kind, linear_joints),
                        float_text(servo.per_radian / slope_unit));
    const auto end = [&](double setpoint) {
      return kind.whole_set_points ? fmt::format("{:.0f}", setpoint) : float_text(setpoint / unit);
    };
    text += fmt::format("{} = {}\n{} = {}\n", key_with_unit(kind, "min"), end(servo.min),
                        key_with_unit(kind, "max"), end(servo.max));
    if (servo.current_limit > 0) text += fmt::format("current_limit = {}\n", servo.current_limit);
  }
  return text;
}

}  // namespace softfinger
