#include <utility>

#include "softfinger/actuation/dynamixel_protocol.hpp"
#include "softfinger/actuation/feetech_protocol.hpp"
#include "softfinger/actuation/servo_table_bus.hpp"

namespace softfinger {

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
    presets.push_back(std::move(list));
  }
  return std::make_unique<ServoTableBus>(std::make_unique<DynamixelProtocol>(), transport,
                                         std::move(presets), clock);
}

std::unique_ptr<ServoBus> make_feetech_bus(const TransportSettings& transport, LineClock& clock) {
  return std::make_unique<ServoTableBus>(
      std::make_unique<FeetechProtocol>(), transport,
      std::vector<std::vector<ServoTableBus::Preset>>(transport.servos.size()), clock);
}

}  // namespace softfinger
