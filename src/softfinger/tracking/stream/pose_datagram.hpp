#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "softfinger/tracking/stream/pose_message.hpp"

namespace softfinger {

/// The datagram of tracker `udp`: 80 bytes, little-endian, offsets in bytes.
///
///      0  "SFPO"
///      4  u32 version, 1
///      8  u32 sequence number, one more with each datagram
///     12  u32 1: the body is tracked, 0: it is not, and the pose is not looked at
///     16  f64 time of the pose on the sender's clock, s
///     24  f64 x, y, z: origin of Ft in W, m
///     48  f64 w, x, y, z: rotation of Ft in W, a unit quaternion
inline constexpr std::size_t kPoseDatagramSize = 80;
using PoseDatagram = std::array<std::uint8_t, kPoseDatagramSize>;

/// None where the bytes are anything but such a datagram.
[[nodiscard]] std::optional<PoseMessage> decode_pose_datagram(std::span<const std::uint8_t> bytes);
/// `message` with sequence and time; 0 where it has none.
[[nodiscard]] PoseDatagram encode_pose_datagram(const PoseMessage& message);

}  // namespace softfinger
