#include "softfinger/device/transport_text.hpp"

#include <fmt/format.h>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

/// A number that TOML takes as a float.
std::string number(double value) { return fmt::format("{:#.9g}", value); }

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
  const std::string& kind = transport.kind;
  const std::string suffix = transport.unit.empty() ? "" : "_" + transport.unit;
  const std::string slope = (transport.unit.empty() ? "" : transport.unit + "_") +
                            (linear_joints || transport.follows_travel ? "per_mm" : "per_deg");
  const double slope_unit =
      transport.unit_scale / (linear_joints || transport.follows_travel ? mm : deg);
  const bool ticks = kind == "dynamixel" || kind == "feetech";
  std::string text =
      fmt::format("[transport]\nkind = \"{}\"\nport = {}\n", kind, quoted(transport.port));
  if (ticks || kind == "maestro") text += fmt::format("baud = {}\n", transport.baud);
  text += fmt::format("rate_Hz = {}\n", number(transport.rate));
  for (const ServoSettings& servo : transport.servos) {
    text += "\n[[transport.servo]]\n";
    if (kind == "osc") {
      text += fmt::format("address = {}\n", quoted(servo.address));
    } else {
      text += fmt::format("{} = {}\n", ticks ? "id" : "channel", servo.channel);
    }
    const double unit = transport.unit_scale;
    text += fmt::format("zero{} = {}\n{} = {}\n", suffix, number(servo.zero / unit), slope,
                        number(servo.per_radian / slope_unit));
    const auto end = [&](double setpoint) {
      return ticks ? fmt::format("{:.0f}", setpoint) : number(setpoint / unit);
    };
    text += fmt::format("min{} = {}\nmax{} = {}\n", suffix, end(servo.min), suffix, end(servo.max));
    if (servo.current_limit > 0) text += fmt::format("current_limit = {}\n", servo.current_limit);
  }
  return text;
}

}  // namespace softfinger
