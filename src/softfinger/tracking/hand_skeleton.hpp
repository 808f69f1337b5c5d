#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "softfinger/geometry/pose.hpp"
#include "softfinger/tracking/hand_part.hpp"
#include "softfinger/tracking/xr_hand.hpp"

namespace softfinger {

enum class HandBone { kMetacarpal, kProximal, kMiddle };
inline constexpr std::array<NameRow<HandBone>, 3> kHandBones{{
    {HandBone::kMetacarpal, "metacarpal"},
    {HandBone::kProximal, "proximal"},
    {HandBone::kMiddle, "middle"},
}};

/// A bone of a hand that is no distal phalanx, as a tapered capsule: lengths and radii of an adult,
/// m.
struct HandPiece {
  HandFinger finger;
  HandBone bone;
  double length;
  double back, front;  ///< radii at the end towards the wrist, and at the other
};

/// Finger by finger, from the wrist outwards; the metacarpals make the palm. Lengths are means of
/// 66 adults (Buryanov and Kotiuk, "Proportions of hand segments", Int. J. Morphol. 28(3):755,
/// 2010), radii our own.
inline constexpr std::array<HandPiece, 14> kHandPieces{{
    {HandFinger::kThumb, HandBone::kMetacarpal, 46.22e-3, 12e-3, 11e-3},
    {HandFinger::kThumb, HandBone::kProximal, 31.57e-3, 10e-3, 9e-3},
    {HandFinger::kIndex, HandBone::kMetacarpal, 68.12e-3, 11e-3, 11e-3},
    {HandFinger::kIndex, HandBone::kProximal, 39.78e-3, 9.5e-3, 8.5e-3},
    {HandFinger::kIndex, HandBone::kMiddle, 22.38e-3, 8.5e-3, 7.5e-3},
    {HandFinger::kMiddle, HandBone::kMetacarpal, 64.60e-3, 11e-3, 11e-3},
    {HandFinger::kMiddle, HandBone::kProximal, 44.63e-3, 9.5e-3, 8.5e-3},
    {HandFinger::kMiddle, HandBone::kMiddle, 26.33e-3, 8.5e-3, 7.5e-3},
    {HandFinger::kRing, HandBone::kMetacarpal, 58.00e-3, 11e-3, 11e-3},
    {HandFinger::kRing, HandBone::kProximal, 41.37e-3, 9e-3, 8e-3},
    {HandFinger::kRing, HandBone::kMiddle, 25.65e-3, 8e-3, 7e-3},
    {HandFinger::kPinky, HandBone::kMetacarpal, 53.69e-3, 11e-3, 10e-3},
    {HandFinger::kPinky, HandBone::kProximal, 32.74e-3, 8e-3, 7e-3},
    {HandFinger::kPinky, HandBone::kMiddle, 18.11e-3, 7e-3, 6.5e-3},
}};
/// Lengths of the distal phalanges, thumb first, from the same source, m.
inline constexpr std::array<double, 5> kDistalLengths{21.67e-3, 15.82e-3, 17.40e-3, 17.30e-3,
                                                      15.96e-3};

/// Where the bones of a hand are, W: each with its origin in the middle, x away from the wrist, z
/// out of the back of the hand, as F of a finger.
struct HandPose {
  std::array<Pose, kHandPieces.size()> pieces;
  std::array<Pose, kHandFingers.size()> distal;  ///< X_WFt, thumb first
};

/// How a hand's joints are turned, rad, 0 where it is flat. Of a finger: to the left, flexion of
/// its knuckle, and that of the next joint, of which the last one takes two thirds (Rijpkema and
/// Girard, "Computer animation of knowledge-based human grasping", SIGGRAPH 1991). Of the thumb:
/// how far it is turned in front of the palm, flexion of its root, and that of its other two
/// joints. Left and right are those of a right hand; a left one is its mirror image.
using HandAngles = std::array<Vector3, kHandFingers.size()>;

/// X_WH is the wrist: x towards the knuckles, y to the thumb's side of a right hand, z out of the
/// back of the hand. `size`: times the lengths above.
[[nodiscard]] HandPose hand_pose(HandSide side, double size, const Pose& X_WH,
                                 const HandAngles& angles);
/// The joint of a headset's hand where a piece begins, for bone_pose().
[[nodiscard]] std::size_t joint_of(std::size_t piece);

}  // namespace softfinger
