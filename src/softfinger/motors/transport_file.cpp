#include "softfinger/motors/transport_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "softfinger/base/units.hpp"
#include "softfinger/motors/motor_kinds.hpp"

namespace softfinger {
namespace {

/// Both ends of the joint limits must be set points the servo may be sent.
void check_cover(const ConfigTable& table, const MotorKind& kind, const ServoSettings& servo,
                 const JointLimits& limits, int joint) {
  for (const double at : {limits.min[joint], limits.max[joint]}) {
    const double setpoint = servo.zero + servo.per_radian * at;
    const double rounding = 1e-6 * kind.unit_scale;
    if (setpoint < servo.min - rounding || setpoint > servo.max + rounding) {
      const double unit = kind.unit_scale;
      table.fail(slope_key(kind, limits.linear),
                 fmt::format("joint {} at its limit of {:g} {} needs {:g}{}{}, out of {} {:g} to "
                             "{} {:g}; widen them or narrow the joint's limits",
                             joint + 1, at / (limits.linear ? mm : deg),
                             limits.linear ? "mm" : "degrees", setpoint / unit,
                             kind.unit.empty() ? "" : " ", kind.unit, key_with_unit(kind, "min"),
                             servo.min / unit, key_with_unit(kind, "max"), servo.max / unit));
    }
  }
}

/// Of `[transport]` itself, whatever its kind.
constexpr std::array kTransportKeys{
    KeyMeaning{"port", "\"emulator\", a serial port, or HOST:PORT for osc and weart"},
    KeyMeaning{"baud", "of the serial port; servos on a bus must be set to the same"},
    KeyMeaning{"rate_Hz", "device ticks a second: one match and one command each"},
    KeyMeaning{"at_end", "\"hold\": servos keep the device retracted; \"torque_off\": they let go"},
    KeyMeaning{"servo", "one a joint, in joint order; weart: the one actuation point"},
};

/// What goes to the wire keeps to the joint's limits already; the servo itself must not be held
/// back by its own.
constexpr double kHardwareReserve = 1.25;

void limit_motion(const JointLimits& limits, ServoSettings& servo) {
  const double scale = kHardwareReserve * std::abs(servo.per_radian);
  servo.max_rate = scale * limits.max_rate;
  if (std::isfinite(limits.max_acceleration)) {
    servo.max_acceleration = scale * limits.max_acceleration;
  }
}

void read_at_end(const ConfigTable& table, const MotorKind& kind, TransportSettings& transport) {
  transport.limp_at_end = table.choice("at_end", {"hold", "torque_off"}, "hold") == "torque_off";
  if (!transport.limp_at_end || kind.has_torque) return;
  table.fail("at_end",
             fmt::format("\"torque_off\" is nothing that {} can be told; leave it out", kind.name));
}

}  // namespace

TransportSettings read_transport(const ConfigTable& table, const JointLimits& limits) {
  TransportSettings transport;
  transport.kind = table.choice("kind", transport_kinds());
  table.decides("kind");
  const MotorKind& kind = motor_kind(transport.kind);
  const bool serial = kind.wire == MotorKind::Wire::kSerial;
  transport.unit = kind.unit;
  transport.unit_scale = kind.unit_scale;
  transport.follows_travel = kind.follows_travel;
  transport.port = table.text("port", "emulator");
  if (transport.port.empty()) {
    table.fail("port", serial ? "must be \"emulator\" or a serial port"
                              : "must be \"emulator\" or HOST:PORT");
  }
  if (serial) transport.baud = table.integer("baud", 300, 4000000, kind.default_baud);
  transport.rate = table.number("rate_Hz", {.min = 0.0, .max = 1000.0, .open_min = true}, 30.0);
  read_at_end(table, kind, transport);
  if (kind.read_line != nullptr) kind.read_line(table, transport);

  const std::vector<ConfigTable> servos = table.tables("servo");
  table.needs_one("servo");
  const auto joints = static_cast<std::size_t>(limits.min.size());
  if (transport.follows_travel && servos.size() != 1) {
    table.fail("servo", fmt::format("{} servos are described; a WEART actuation point is one "
                                    "([[transport.servo]])",
                                    servos.size()));
  }
  if (!transport.follows_travel && servos.size() != joints) {
    table.fail("servo", fmt::format("{} servos are described; this device has {}, one a joint in "
                                    "joint order ([[transport.servo]])",
                                    servos.size(), joints));
  }
  for (const ConfigTable& servo : servos) {
    const auto joint = static_cast<int>(transport.servos.size());
    ServoSettings read = kind.read_servo(servo, slope_key(kind, limits.linear), limits, joint);
    if (!transport.follows_travel) limit_motion(limits, read);
    if (!transport.follows_travel) check_cover(servo, kind, read, limits, joint);
    const std::string name = kind.servo_name(read);
    for (int other = 0; other < joint; ++other) {
      if (kind.servo_name(transport.servos[static_cast<std::size_t>(other)]) != name) continue;
      servo.fail(kind.servo_key, fmt::format("{} is servo {}'s already", name, other + 1));
    }
    transport.servos.push_back(read);
  }
  return transport;
}

std::string transport_example(std::string_view kind_name, const JointLimits& limits) {
  const MotorKind& kind = motor_kind(kind_name);
  std::string text = fmt::format("[transport]\nkind = \"{}\"\n", kind.name);
  const auto joints = static_cast<int>(limits.min.size());
  const int servos = kind.follows_travel ? 1 : std::min(joints, kMostServos);
  for (int joint = 0; joint < servos; ++joint) {
    text += "[[transport.servo]]\n" + kind.servo_example(slope_key(kind, limits.linear), joint);
  }
  return text;
}

std::string_view transport_key_meaning(std::string_view kind, std::string_view key) {
  for (const KeyMeaning& meaning : kTransportKeys) {
    if (meaning.key == key) return meaning.text;
  }
  for (const auto& keys : {motor_kind(kind).line_keys, motor_kind(kind).keys}) {
    for (const KeyMeaning& meaning : keys) {
      if (meaning.key == key) return meaning.text;
    }
  }
  return {};
}

}  // namespace softfinger
