#include "softfinger/device/transport_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

/// Turn of a servo on a bus in ticks.
constexpr double kTurn = 4096.0;
/// Steps of numbers sent as text or float, fine enough for any motor.
constexpr double kFineStep = 1e-6;
/// Bounds numbers sent by OSC, so that they are whole numbers of fine steps in 32 bits.
constexpr double kLargestNumber = 2000.0;

/// How a kind of transport says a set point.
struct Wording {
  std::string unit;   ///< suffix of keys, may be empty
  std::string slope;  ///< key of the set point per joint angle
};

Wording wording(std::string_view kind, bool linear) {
  const std::string per = linear ? "per_mm" : "per_deg";
  if (kind == "maestro") return {"us", "us_" + per};
  if (kind == "dynamixel" || kind == "feetech") return {"ticks", "ticks_" + per};
  return {"", kind == "weart" ? "per_mm" : per};
}

std::string with_unit(std::string_view name, const Wording& words) {
  return words.unit.empty() ? std::string(name) : fmt::format("{}_{}", name, words.unit);
}

double read_slope(const ConfigTable& table, const std::string& key) {
  const double slope = table.number(key);
  if (slope == 0.0) table.fail(key, "must not be 0: the servo would not move");
  return slope;
}

ServoSettings read_maestro_servo(const ConfigTable& table, const Wording& words) {
  ServoSettings servo;
  servo.channel = table.integer("channel", 0, kMostServos - 1);
  servo.zero = table.number("zero_us", Range::positive());
  servo.per_radian = read_slope(table, words.slope);
  servo.min = table.number("min_us", Range::positive());
  servo.max = table.number("max_us", Range::positive());
  if (servo.min >= servo.max) table.fail("min_us", "must be less than max_us");
  // The Maestro's targets are 14-bit quarters of a microsecond.
  if (servo.max > 4095.75 * us) table.fail("max_us", "must be at most 4095.75, the longest pulse");
  return servo;
}

ServoSettings read_bus_servo(const ConfigTable& table, const Wording& words, bool dynamixel) {
  ServoSettings servo;
  servo.step = 1.0;
  servo.channel = table.integer("id", 0, dynamixel ? 252 : 253);
  servo.zero = table.number("zero_ticks", Range::between(-kTurn, 2.0 * kTurn));
  servo.per_radian = read_slope(table, words.slope);
  servo.min = table.integer("min_ticks", 0, 4095);
  servo.max = table.integer("max_ticks", 0, 4095);
  if (servo.min >= servo.max) table.fail("min_ticks", "must be less than max_ticks");
  if (dynamixel) servo.current_limit = table.integer("current_limit", 0, 2047, 0);
  return servo;
}

ServoSettings read_osc_servo(const ConfigTable& table, const Wording& words,
                             const JointLimits& limits, int joint) {
  ServoSettings servo;
  servo.step = kFineStep;
  servo.address = table.text("address");
  const auto plain = [](char c) {
    return c > ' ' && c <= '~' && std::string_view("#*,?[]{}").find(c) == std::string_view::npos;
  };
  if (servo.address.size() < 2 || servo.address.size() > 100 || servo.address.front() != '/' ||
      !std::all_of(servo.address.begin(), servo.address.end(), plain)) {
    table.fail("address",
               "must be an OSC address such as \"/device/joint/1\", at most 100 letters");
  }
  const Range range = Range::between(-kLargestNumber, kLargestNumber);
  servo.zero = table.number("zero", range, 0.0);
  servo.per_radian = table.number(words.slope, Range::any(), 1.0 / (limits.linear ? mm : deg));
  if (servo.per_radian == 0.0) table.fail(words.slope, "must not be 0: nothing would move");
  const auto [low, high] = std::minmax({servo.zero + servo.per_radian * limits.min[joint],
                                        servo.zero + servo.per_radian * limits.max[joint]});
  if (low < -kLargestNumber || high > kLargestNumber) {
    table.fail(words.slope, fmt::format("leads to numbers up to {:g}; at most {:g} can be sent",
                                        std::max(-low, high), kLargestNumber));
  }
  servo.min = table.number("min", range, low);
  servo.max = table.number("max", range, high);
  if (servo.min >= servo.max) table.fail("min", "must be less than max");
  return servo;
}

std::string upper_case(std::string text) {
  for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

ServoSettings read_weart_servo(const ConfigTable& table, const Wording& words) {
  ServoSettings servo;
  servo.step = kFineStep;
  const std::string hand = table.choice("hand", {"left", "right"});
  const std::string point =
      table.choice("point", {"thumb", "index", "middle", "annular", "pinky", "palm"});
  servo.address = upper_case(hand) + ":" + upper_case(point);
  servo.zero = table.number("zero", Range::between(-10.0, 10.0));
  servo.per_radian = table.number(words.slope, Range::positive());
  servo.min = table.number("min", Range::between(0.0, 1.0), 0.0);
  servo.max = table.number("max", Range::between(0.0, 1.0), 1.0);
  if (servo.min >= servo.max) table.fail("min", "must be less than max");
  return servo;
}

/// Both ends of the joint limits must be set points the servo may be sent.
void check_cover(const ConfigTable& table, const Wording& words, const TransportSettings& transport,
                 const ServoSettings& servo, const JointLimits& limits, int joint) {
  for (const double at : {limits.min[joint], limits.max[joint]}) {
    const double setpoint = servo.zero + servo.per_radian * at;
    const double rounding = 1e-6 * transport.unit_scale;
    if (setpoint < servo.min - rounding || setpoint > servo.max + rounding) {
      const double unit = transport.unit_scale;
      table.fail(words.slope,
                 fmt::format("joint {} at its limit of {:g} {} needs {:g}{}{}, out of {} {:g} to "
                             "{} {:g}; widen them or narrow the joint's limits",
                             joint + 1, at / (limits.linear ? mm : deg),
                             limits.linear ? "mm" : "degrees", setpoint / unit,
                             words.unit.empty() ? "" : " ", words.unit, with_unit("min", words),
                             servo.min / unit, with_unit("max", words), servo.max / unit));
    }
  }
}

int default_baud(std::string_view kind) {
  if (kind == "dynamixel") return 57600;
  return kind == "feetech" ? 1000000 : 115200;
}

/// By what servos are told apart.
std::string_view name_key(std::string_view kind) {
  if (kind == "maestro") return "channel";
  return kind == "osc" ? "address" : "id";
}

}  // namespace

const std::vector<std::string>& transport_kinds() {
  static const std::vector<std::string> kKinds{"maestro", "dynamixel", "feetech", "osc", "weart"};
  return kKinds;
}

TransportSettings read_transport(const ConfigTable& table, const JointLimits& limits) {
  TransportSettings transport;
  transport.kind = table.choice("kind", transport_kinds());
  table.decides("kind");
  const std::string& kind = transport.kind;
  const Wording words = wording(kind, limits.linear);
  const bool serial = kind != "osc" && kind != "weart";
  transport.unit = words.unit;
  transport.unit_scale = kind == "maestro" ? us : 1.0;
  transport.follows_travel = kind == "weart";
  transport.port = table.text("port", "emulator");
  if (transport.port.empty()) {
    table.fail("port", serial ? "must be \"emulator\" or a serial port"
                              : "must be \"emulator\" or HOST:PORT");
  }
  if (serial) transport.baud = table.integer("baud", 300, 4000000, default_baud(kind));
  transport.rate = table.number("rate_Hz", {.min = 0.0, .max = 1000.0, .open_min = true}, 30.0);

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
    if (kind == "maestro") {
      transport.servos.push_back(read_maestro_servo(servo, words));
    } else if (kind == "osc") {
      transport.servos.push_back(read_osc_servo(servo, words, limits, joint));
    } else if (kind == "weart") {
      transport.servos.push_back(read_weart_servo(servo, words));
    } else {
      transport.servos.push_back(read_bus_servo(servo, words, kind == "dynamixel"));
    }
    const ServoSettings& read = transport.servos.back();
    if (!transport.follows_travel) check_cover(servo, words, transport, read, limits, joint);
    for (int other = 0; other < joint; ++other) {
      const ServoSettings& before = transport.servos[static_cast<std::size_t>(other)];
      const bool same =
          kind == "osc" ? before.address == read.address : before.channel == read.channel;
      if (!same) continue;
      servo.fail(
          name_key(kind),
          fmt::format("{} is servo {}'s already",
                      kind == "osc" ? read.address : std::to_string(read.channel), other + 1));
    }
  }
  return transport;
}

std::string transport_example(std::string_view kind, const JointLimits& limits) {
  const bool linear = limits.linear;
  std::string text = fmt::format("[transport]\nkind = \"{}\"\n", kind);
  for (int joint = 0; joint < limits.min.size() && joint < kMostServos; ++joint) {
    text += "[[transport.servo]]\n";
    const std::string slope = wording(kind, linear).slope;
    if (kind == "maestro") {
      text += fmt::format(
          "channel = {}\nzero_us = 1500.0\n{} = 0.1\nmin_us = 1000.0\nmax_us = 2000.0\n", joint,
          slope);
    } else if (kind == "osc") {
      text += fmt::format("address = \"/joint/{}\"\n", joint + 1);
    } else if (kind == "weart") {
      text += "hand = \"right\"\npoint = \"index\"\nzero = 0.0\nper_mm = 0.1\n";
      break;
    } else {
      text +=
          fmt::format("id = {}\nzero_ticks = 2048.0\n{} = 0.1\nmin_ticks = 0\nmax_ticks = 4095\n",
                      joint, slope);
    }
  }
  return text;
}

std::string_view transport_key_meaning(std::string_view kind, std::string_view key) {
  struct Meaning {
    std::string_view kind, key, text;
  };
  static constexpr std::array kMeanings{
      Meaning{"", "port", "\"emulator\", a serial port, or HOST:PORT for osc and weart"},
      Meaning{"", "baud", "of the serial port; servos on a bus must be set to the same"},
      Meaning{"", "rate_Hz", "device ticks a second: one match and one command each"},
      Meaning{"", "servo", "one a joint, in joint order; weart: the one actuation point"},
      Meaning{"", "channel", "of the Maestro"},
      Meaning{"", "id", "of the servo on its bus"},
      Meaning{"", "zero_us", "pulse width at joint angle 0"},
      Meaning{"", "us_per_deg", "pulse = zero_us + us_per_deg * joint angle"},
      Meaning{"", "us_per_mm", "pulse = zero_us + us_per_mm * joint length"},
      Meaning{"", "min_us", "shortest pulse ever sent"},
      Meaning{"", "max_us", "longest pulse ever sent"},
      Meaning{"", "zero_ticks", "position in ticks, 4096 a turn, at joint angle 0"},
      Meaning{"", "ticks_per_deg", "position = zero_ticks + ticks_per_deg * joint angle"},
      Meaning{"", "ticks_per_mm", "position = zero_ticks + ticks_per_mm * joint length"},
      Meaning{"", "min_ticks", "least position ever sent; dynamixel: the servo's own limit too"},
      Meaning{"", "max_ticks", "largest position ever sent; dynamixel: the servo's own limit too"},
      Meaning{"", "current_limit",
              "in the servo's own unit (2.69 mA for XM430, 1 mA for XL330); with it the servo "
              "holds its position with no more current than that; 0: as the servo is set"},
      Meaning{"", "address", "OSC address of the joint's message"},
      Meaning{"weart", "hand", "\"left\" or \"right\""},
      Meaning{"weart", "point", "which actuation point of the hand"},
      Meaning{"weart", "zero", "force, 0 to 1, at travel 0 of the device"},
      Meaning{"weart", "per_mm", "force = zero + per_mm * travel"},
      Meaning{"weart", "min", "least force ever sent; 0 is sent as stopForce"},
      Meaning{"weart", "max", "largest force ever sent"},
      Meaning{"osc", "zero", "number sent at joint angle 0"},
      Meaning{"osc", "per_deg", "number = zero + per_deg * joint angle"},
      Meaning{"osc", "per_mm", "number = zero + per_mm * joint length"},
      Meaning{"osc", "min", "least number ever sent"},
      Meaning{"osc", "max", "largest number ever sent"},
  };
  for (const Meaning& meaning : kMeanings) {
    if (meaning.key == key && (meaning.kind.empty() || meaning.kind == kind)) return meaning.text;
  }
  return {};
}

}  // namespace softfinger
