#include "softfinger/motors/weart/weart_kind.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "softfinger/motors/weart/weart_bus.hpp"
#include "softfinger/motors/weart/weart_emulator.hpp"

namespace softfinger {
namespace {

constexpr std::array kWeartKeys{
    KeyMeaning{"hand", "\"left\" or \"right\""},
    KeyMeaning{"point", "which actuation point of the hand"},
    KeyMeaning{"zero", "force, 0 to 1, at travel 0 of the device"},
    KeyMeaning{"per_mm", "force = zero + per_mm * travel"},
    KeyMeaning{"min", "least force ever sent; 0 is sent as stopForce"},
    KeyMeaning{"max", "largest force ever sent"},
};

std::string in_case(std::string text, char first, char to) {
  for (char& c : text) c = c >= first && c < first + 26 ? static_cast<char>(c - first + to) : c;
  return text;
}

ServoSettings read_weart_servo(const ConfigTable& table, const std::string& slope,
                               const JointLimits&, int) {
  ServoSettings servo;
  servo.step = kFineStep;
  const std::string hand = table.choice("hand", {"left", "right"});
  const std::string point =
      table.choice("point", {"thumb", "index", "middle", "annular", "pinky", "palm"});
  servo.address = in_case(hand + ":" + point, 'a', 'A');
  servo.zero = table.number("zero", Range::between(-10.0, 10.0));
  servo.per_radian = table.number(slope, Range::positive());
  servo.min = table.number("min", Range::between(0.0, 1.0), 0.0);
  servo.max = table.number("max", Range::between(0.0, 1.0), 1.0);
  if (servo.min >= servo.max) table.fail("min", "must be less than max");
  return servo;
}

/// The address is "HAND:POINT".
std::string weart_name_text(const ServoSettings& servo) {
  const std::string_view address = servo.address;
  const std::size_t colon = std::min(address.find(':'), address.size() - 1);
  return fmt::format("hand = \"{}\"\npoint = \"{}\"\n",
                     in_case(std::string(address.substr(0, colon)), 'A', 'a'),
                     in_case(std::string(address.substr(colon + 1)), 'A', 'a'));
}

}  // namespace

const MotorKind& weart_kind() {
  static const MotorKind kKind{
      .name = "weart",
      .wire = MotorKind::Wire::kTcp,
      .unit = "",
      .follows_travel = true,
      .left_alone = "thimbles keep the last force if this computer dies",
      .servo_key = "point",
      .keys = kWeartKeys,
      .read_servo = read_weart_servo,
      .servo_example =
          [](const std::string& slope, int) {
            return fmt::format("hand = \"right\"\npoint = \"index\"\nzero = 0.0\n{} = 0.1\n",
                               slope);
          },
      .servo_name = [](const ServoSettings& servo) { return servo.address; },
      .servo_name_text = weart_name_text,
      .make_bus = [](const TransportSettings& transport, LineClock&) -> std::unique_ptr<ServoBus> {
        return std::make_unique<WeartBus>(transport);
      },
      .make_emulator = [](const TransportSettings& transport,
                          std::span<const EmulatedServo> servos) -> std::unique_ptr<BusEmulator> {
        return std::make_unique<WeartEmulator>(transport, servos.front());
      },
  };
  return kKind;
}

}  // namespace softfinger
