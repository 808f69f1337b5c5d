#pragma once

#include <array>
#include <cstddef>

#include "softfinger/geometry/pose.hpp"
#include "softfinger/tracking/hand_part.hpp"

namespace softfinger {

/// Joints of a hand, in the order of WebXR's XRHandJoint: the wrist, four of the thumb, five of
/// each finger (W3C, WebXR Hand Input Module, section "Skeleton Joints").
inline constexpr std::size_t kXrJointCount = 25;

/// A joint in the frame K of a headset: right-handed, y up, m. Its own axes: -z along the bone,
/// away from the wrist, -y out of the palm's side.
struct XrJoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  Eigen::Quaternionf rotation = Eigen::Quaternionf::Identity();  ///< unit, joint to K
  float radius = 0.0F;                                           ///< m, joint to skin
};

/// What a headset says of one hand in one of its frames.
struct XrHand {
  HandSide side = HandSide::kRight;
  bool tracked = false;  ///< else the joints mean nothing
  double time = 0.0;     ///< s, on the headset's own clock
  std::array<XrJoint, kXrJointCount> joints;
};

/// Of the bone from a joint of the hand to the next, its origin in the middle, x to the next joint,
/// z out of the back of the hand; W and K as below.
[[nodiscard]] Pose bone_pose(const XrHand& hand, std::size_t joint);

/// Where the distal phalanx begins; the tip follows.
[[nodiscard]] std::size_t distal_joint(HandFinger finger);
/// X_WFt of a finger of a tracked hand, where W lies in K as a z-up world in a y-up one: x_W = -z,
/// y_W = -x, z_W = y. Ft has its origin halfway from the distal joint to the tip, x to the tip.
[[nodiscard]] Pose distal_phalanx_pose(const XrHand& hand, HandFinger finger);

}  // namespace softfinger
