#pragma once

#include "softfinger/motors/servo_table/servo_protocol.hpp"

namespace softfinger {

/// Dynamixel Protocol 2.0 and the control table of the X series (ROBOTIS e-Manual, "DYNAMIXEL
/// Protocol 2.0", sections 2 to 4, and "XM430-W350", "Control Table").
///
/// FF FF FD 00 id length(2) instruction parameters crc(2), length counting from the instruction on.
/// Inside instruction and parameters an FD is stuffed in after every FF FF FD. Positions are signed
/// 32 bits, 4096 ticks a turn.
class DynamixelProtocol : public ServoProtocol {
 public:
  [[nodiscard]] const ControlTable& table() const override;
  std::size_t encode(const ServoFrame& frame, std::span<std::uint8_t> out) const override;
  [[nodiscard]] int frame_length(std::span<const std::uint8_t> bytes) const override;
  [[nodiscard]] ServoFrame decode(std::span<const std::uint8_t> bytes) const override;
  [[nodiscard]] std::optional<ServoStatus> status(const ServoFrame& frame) const override;
  [[nodiscard]] ServoFrame status_frame(std::uint8_t id, std::uint8_t error,
                                        std::span<const std::uint8_t> data) const override;
  [[nodiscard]] std::uint8_t complaints(std::uint32_t errors) const override;
  [[nodiscard]] std::uint32_t to_register(std::int32_t position) const override {
    return static_cast<std::uint32_t>(position);
  }
  [[nodiscard]] std::int32_t to_position(std::uint32_t value) const override {
    return static_cast<std::int32_t>(value);
  }
};

/// Registers of the X series beside those of ControlTable. Those below 64 are kept without power
/// and can be written only while torque is off.
namespace dynamixel {
inline constexpr ServoRegister kOperatingMode{11, 1};
inline constexpr ServoRegister kCurrentLimit{38, 2};
inline constexpr ServoRegister kMaxPosition{48, 4};
inline constexpr ServoRegister kMinPosition{52, 4};
inline constexpr ServoRegister kGoalCurrent{102, 2};
inline constexpr ServoRegister kProfileAcceleration{108, 4};
inline constexpr ServoRegister kProfileVelocity{112, 4};
inline constexpr double kProfileVelocityUnit = 0.229 * 4096.0 / 60.0;          ///< ticks per s
inline constexpr double kProfileAccelerationUnit = 214.577 * 4096.0 / 3600.0;  ///< ticks per s^2
inline constexpr std::uint32_t kMostProfile = 32767;
inline constexpr std::uint32_t kPositionMode = 3;
inline constexpr std::uint32_t kCurrentBasedPositionMode = 5;
inline constexpr std::uint16_t kFirstVolatile = 64;
/// Errors of a status; bit 7 besides says that the servo has an alert of its own.
inline constexpr std::uint8_t kInstructionError = 2;
inline constexpr std::uint8_t kRangeError = 4;
inline constexpr std::uint8_t kLengthError = 5;
inline constexpr std::uint8_t kLimitError = 6;
inline constexpr std::uint8_t kAccessError = 7;
}  // namespace dynamixel

/// CRC-16 with polynomial 0x8005, from 0, most significant bit first.
[[nodiscard]] std::uint16_t dynamixel_crc(std::span<const std::uint8_t> bytes);

}  // namespace softfinger
