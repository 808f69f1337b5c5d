#include "softfinger/motors/dynamixel/dynamixel_kind.hpp"

#include <utility>
#include <vector>

#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"
#include "softfinger/motors/servo_table/servo_table_bus.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"
#include "softfinger/motors/servo_table/servo_table_settings.hpp"

namespace softfinger {
namespace {

ServoSettings read_dynamixel_servo(const ConfigTable& table, const std::string& slope,
                                   const JointLimits&, int) {
  ServoSettings servo = read_table_servo(table, slope, 252);
  servo.current_limit = table.integer("current_limit", 0, 2047, 0);
  return servo;
}

/// Operating mode, position limits, speed and acceleration and, where given, the current limit.
std::unique_ptr<ServoBus> make_dynamixel_bus(const TransportSettings& transport, LineClock& clock) {
  std::vector<std::vector<ServoTableBus::Preset>> presets;
  for (const ServoSettings& servo : transport.servos) {
    const auto limit = static_cast<std::uint32_t>(servo.current_limit);
    // A current below the motor's own is held only in current-based position control.
    std::vector<ServoTableBus::Preset> list{
        {dynamixel::kOperatingMode,
         limit > 0 ? dynamixel::kCurrentBasedPositionMode : dynamixel::kPositionMode, true},
        {dynamixel::kMinPosition, static_cast<std::uint32_t>(servo.min), true},
        {dynamixel::kMaxPosition, static_cast<std::uint32_t>(servo.max), true}};
    if (limit > 0) {
      list.push_back({dynamixel::kCurrentLimit, limit, true});
      list.push_back({dynamixel::kGoalCurrent, limit, false});
    }
    if (servo.max_rate > 0.0) {
      list.push_back({dynamixel::kProfileAcceleration,
                      servo.max_acceleration > 0.0
                          ? at_least(servo.max_acceleration / dynamixel::kProfileAccelerationUnit,
                                     dynamixel::kMostProfile)
                          : 0U,
                      false});
      list.push_back(
          {dynamixel::kProfileVelocity,
           at_least(servo.max_rate / dynamixel::kProfileVelocityUnit, dynamixel::kMostProfile),
           false});
    }
    presets.push_back(std::move(list));
  }
  return std::make_unique<ServoTableBus>(std::make_unique<DynamixelProtocol>(), transport,
                                         std::move(presets), clock);
}

}  // namespace

const MotorKind& dynamixel_kind() {
  static const MotorKind kKind = [] {
    MotorKind kind = servo_table_kind();
    kind.name = "dynamixel";
    kind.default_baud = 57600;
    kind.read_servo = read_dynamixel_servo;
    kind.make_bus = make_dynamixel_bus;
    kind.make_emulator = [](const TransportSettings&,
                            std::span<const EmulatedServo> servos) -> std::unique_ptr<BusEmulator> {
      return std::make_unique<ServoTableEmulator>(std::make_unique<DynamixelProtocol>(), servos);
    };
    return kind;
  }();
  return kKind;
}

}  // namespace softfinger
