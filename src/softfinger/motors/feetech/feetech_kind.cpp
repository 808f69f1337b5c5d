#include "softfinger/motors/feetech/feetech_kind.hpp"

#include <utility>
#include <vector>

#include "softfinger/motors/feetech/feetech_protocol.hpp"
#include "softfinger/motors/servo_table/servo_table_bus.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"
#include "softfinger/motors/servo_table/servo_table_settings.hpp"

namespace softfinger {

const MotorKind& feetech_kind() {
  static const MotorKind kKind = [] {
    MotorKind kind = servo_table_kind();
    kind.name = "feetech";
    kind.left_alone = "its servos keep the last command if this computer dies";
    kind.default_baud = 1000000;
    kind.read_servo = [](const ConfigTable& table, const std::string& slope, const JointLimits&,
                         int) { return read_table_servo(table, slope, 253); };
    kind.make_bus = [](const TransportSettings& transport,
                       LineClock& clock) -> std::unique_ptr<ServoBus> {
      std::vector<std::vector<ServoTableBus::Preset>> presets;
      for (const ServoSettings& servo : transport.servos) {
        auto& list = presets.emplace_back();
        if (servo.max_rate <= 0.0) continue;
        if (servo.max_acceleration > 0.0) {
          list.push_back({feetech::kAcceleration,
                          at_least(servo.max_acceleration / feetech::kAccelerationUnit,
                                   feetech::kMostAcceleration),
                          false});
        }
        list.push_back({feetech::kSpeed, at_least(servo.max_rate, feetech::kMostSpeed), false});
      }
      return std::make_unique<ServoTableBus>(std::make_unique<FeetechProtocol>(), transport,
                                             std::move(presets), clock);
    };
    kind.make_emulator = [](const TransportSettings&,
                            std::span<const EmulatedServo> servos) -> std::unique_ptr<BusEmulator> {
      return std::make_unique<ServoTableEmulator>(std::make_unique<FeetechProtocol>(), servos);
    };
    return kind;
  }();
  return kKind;
}

}  // namespace softfinger
