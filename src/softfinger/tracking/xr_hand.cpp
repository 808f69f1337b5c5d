#include "softfinger/tracking/xr_hand.hpp"

namespace softfinger {
namespace {

/// Of the distal joint; the tip follows it.
constexpr std::size_t distal_joint(HandFinger finger) {
  constexpr std::array<std::size_t, 5> kDistal{3, 8, 13, 18, 23};
  return kDistal.at(static_cast<std::size_t>(finger));
}

}  // namespace

Pose distal_phalanx_pose(const XrHand& hand, HandFinger finger) {
  // Also the axes of F among a joint's: x_F = -z, y_F = -x, z_F = y.
  const Matrix3 z_up{{0.0, 0.0, -1.0}, {-1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
  const std::size_t distal = distal_joint(finger);
  const XrJoint& joint = hand.joints.at(distal);
  const XrJoint& tip = hand.joints.at(distal + 1);
  const Matrix3 R_KJ = joint.rotation.cast<double>().normalized().toRotationMatrix();
  const Vector3 middle = 0.5 * (joint.position.cast<double>() + tip.position.cast<double>());
  return {z_up * R_KJ * z_up.transpose(), z_up * middle};
}

}  // namespace softfinger
