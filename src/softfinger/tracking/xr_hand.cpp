#include "softfinger/tracking/xr_hand.hpp"

namespace softfinger {

std::size_t distal_joint(HandFinger finger) {
  constexpr std::array<std::size_t, 5> kDistal{3, 8, 13, 18, 23};
  return kDistal.at(static_cast<std::size_t>(finger));
}

Pose bone_pose(const XrHand& hand, std::size_t joint) {
  // Also the axes of F among a joint's: x_F = -z, y_F = -x, z_F = y.
  const Matrix3 z_up{{0.0, 0.0, -1.0}, {-1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
  const XrJoint& from = hand.joints.at(joint);
  const XrJoint& to = hand.joints.at(joint + 1);
  const Matrix3 R_KJ = from.rotation.cast<double>().normalized().toRotationMatrix();
  const Vector3 middle = 0.5 * (from.position.cast<double>() + to.position.cast<double>());
  return {z_up * R_KJ * z_up.transpose(), z_up * middle};
}

Pose distal_phalanx_pose(const XrHand& hand, HandFinger finger) {
  return bone_pose(hand, distal_joint(finger));
}

}  // namespace softfinger
