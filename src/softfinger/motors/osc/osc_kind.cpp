#include "softfinger/motors/osc/osc_kind.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "softfinger/base/units.hpp"
#include "softfinger/motors/osc/osc_bus.hpp"
#include "softfinger/motors/osc/osc_emulator.hpp"

namespace softfinger {
namespace {

/// Bounds numbers sent by OSC, so that they are whole numbers of fine steps in 32 bits.
constexpr double kLargestNumber = 2000.0;

constexpr std::array kOscKeys{
    KeyMeaning{"address", "OSC address of the joint's message"},
    KeyMeaning{"zero", "number sent at joint angle 0"},
    KeyMeaning{"per_deg", "number = zero + per_deg * joint angle"},
    KeyMeaning{"per_mm", "number = zero + per_mm * joint length"},
    KeyMeaning{"min", "least number ever sent"},
    KeyMeaning{"max", "largest number ever sent"},
};

ServoSettings read_osc_servo(const ConfigTable& table, const std::string& slope,
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
  servo.per_radian = table.number(slope, Range::any(), 1.0 / (limits.linear ? mm : deg));
  if (servo.per_radian == 0.0) table.fail(slope, "must not be 0: nothing would move");
  const auto [low, high] = std::minmax({servo.zero + servo.per_radian * limits.min[joint],
                                        servo.zero + servo.per_radian * limits.max[joint]});
  if (low < -kLargestNumber || high > kLargestNumber) {
    table.fail(slope, fmt::format("leads to numbers up to {:g}; at most {:g} can be sent",
                                  std::max(-low, high), kLargestNumber));
  }
  servo.min = table.number("min", range, low);
  servo.max = table.number("max", range, high);
  if (servo.min >= servo.max) table.fail("min", "must be less than max");
  return servo;
}

}  // namespace

const MotorKind& osc_kind() {
  static const MotorKind kKind{
      .name = "osc",
      .wire = MotorKind::Wire::kUdp,
      .unit = "",
      .left_alone =
          "motors keep the last command if this computer dies, unless who listens there "
          "has a timeout",
      .servo_key = "address",
      .keys = kOscKeys,
      .read_servo = read_osc_servo,
      .servo_example =
          [](const std::string&, int joint) {
            return fmt::format("address = \"/joint/{}\"\n", joint + 1);
          },
      .servo_name = [](const ServoSettings& servo) { return servo.address; },
      // Nothing in an address needs an escape but the quotation mark and the backslash.
      .servo_name_text =
          [](const ServoSettings& servo) {
            std::string text = "address = \"";
            for (const char c : servo.address) {
              if (c == '"' || c == '\\') text += '\\';
              text += c;
            }
            return text + "\"\n";
          },
      .make_bus = [](const TransportSettings& transport, LineClock&) -> std::unique_ptr<ServoBus> {
        return std::make_unique<OscBus>(transport);
      },
      .make_emulator = [](const TransportSettings& transport,
                          std::span<const EmulatedServo> servos) -> std::unique_ptr<BusEmulator> {
        return std::make_unique<OscEmulator>(transport, servos);
      },
  };
  return kKind;
}

}  // namespace softfinger
