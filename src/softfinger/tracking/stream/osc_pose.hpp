#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "softfinger/tracking/stream/pose_message.hpp"

namespace softfinger {

/// The OSC message of tracker `osc`: seven numbers, all float32 (`fffffff`) or all float64
/// (`ddddddd`): x, y, z of Ft's origin in W (m), then w, x, y, z of its rotation.
inline constexpr std::string_view kOscPoseAddress = "/finger/pose";

/// The last such message in an OSC 1.0 packet, a message or a bundle of them, nested at most four
/// deep. None where the packet has none or breaks the format anywhere (The Open Sound Control 1.0
/// Specification, 2002); other messages in it are passed over. Time tags are not looked at.
[[nodiscard]] std::optional<PoseMessage> decode_osc_pose(std::span<const std::uint8_t> packet);
/// As one message, float64 or float32.
[[nodiscard]] std::vector<std::uint8_t> encode_osc_pose(const Pose& X_WFt, bool float64);

}  // namespace softfinger
