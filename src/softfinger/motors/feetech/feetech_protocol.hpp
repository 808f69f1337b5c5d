#pragma once

#include "softfinger/motors/servo_table/servo_protocol.hpp"

namespace softfinger {

/// Protocol and control table of Feetech's STS and SMS servos (Feetech, "FT-SCS communication
/// protocol" and "STS series memory table"). SCS servos, high byte first, are not spoken to.
///
/// FF FF id length instruction parameters checksum; a status has its error where requests have the
/// instruction. The checksum is the complement of the sum of all after the header. Positions have
/// 15 bits and a sign, 4096 ticks a turn.
class FeetechProtocol : public ServoProtocol {
 public:
  [[nodiscard]] const ControlTable& table() const override;
  std::size_t encode(const ServoFrame& frame, std::span<std::uint8_t> out) const override;
  [[nodiscard]] int frame_length(std::span<const std::uint8_t> bytes) const override;
  [[nodiscard]] ServoFrame decode(std::span<const std::uint8_t> bytes) const override;
  [[nodiscard]] std::optional<ServoStatus> status(const ServoFrame& frame) const override;
  [[nodiscard]] ServoFrame status_frame(std::uint8_t id, std::uint8_t error,
                                        std::span<const std::uint8_t> data) const override;
  [[nodiscard]] std::uint8_t complaints(std::uint32_t errors) const override;
  [[nodiscard]] std::uint32_t to_register(std::int32_t position) const override;
  [[nodiscard]] std::int32_t to_position(std::uint32_t value) const override;
};

/// Registers of the STS series beside those of ControlTable; forgotten without power.
namespace feetech {
inline constexpr ServoRegister kAcceleration{41, 1};
inline constexpr ServoRegister kSpeed{46, 2};       ///< ticks per s; 0: as fast as it can
inline constexpr double kAccelerationUnit = 100.0;  ///< ticks per s^2; 0: none
inline constexpr std::uint32_t kMostAcceleration = 254;
inline constexpr std::uint32_t kMostSpeed = 3400;
}  // namespace feetech

}  // namespace softfinger
