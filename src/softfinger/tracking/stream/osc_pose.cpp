#include "softfinger/tracking/stream/osc_pose.hpp"

#include <array>

#include "softfinger/wire/osc.hpp"

namespace softfinger {

std::optional<PoseMessage> decode_osc_pose(std::span<const std::uint8_t> packet) {
  std::optional<PoseMessage> found;
  const bool whole = read_osc(packet, [&](const OscMessage& message) {
    if (message.address != kOscPoseAddress) return true;
    std::array<double, 7> v{};
    if (!message.read(v)) return false;
    const auto pose = pose_from_outside({v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]});
    if (!pose) return false;
    found = PoseMessage{.X_WFt = *pose, .valid = true, .sequence = {}, .time = {}};
    return true;
  });
  return whole ? found : std::nullopt;
}

std::vector<std::uint8_t> encode_osc_pose(const Pose& X_WFt, bool float64) {
  const Eigen::Quaterniond q(X_WFt.rotation);
  const Vector3& p = X_WFt.translation;
  const std::array numbers{p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
  const OscNumber type = float64 ? OscNumber::kFloat64 : OscNumber::kFloat32;
  std::vector<std::uint8_t> bytes(osc_message_size(kOscPoseAddress, numbers.size(), type));
  OscWriter(bytes).message(kOscPoseAddress, numbers, type);
  return bytes;
}

}  // namespace softfinger
