#include "softfinger/tracking/hand_skeleton.hpp"

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

/// Where the metacarpals begin, in H of a right hand, and how far they spread to the left.
struct Root {
  Vector3 place;
  double spread;
};
const std::array<Root, kHandFingers.size()> kRoots{{
    {Vector3(12.0, 16.0, -6.0) * mm, 40.0 * deg},
    {Vector3(20.0, 12.0, 0.0) * mm, 6.0 * deg},
    {Vector3(22.0, 2.0, 1.0) * mm, 0.0 * deg},
    {Vector3(21.0, -7.0, 0.0) * mm, -7.0 * deg},
    {Vector3(19.0, -15.0, -2.0) * mm, -14.0 * deg},
}};
constexpr double kLastJoint = 2.0 / 3.0;  ///< of the flexion of the joint before

Matrix3 about(int axis, double angle) { return exp_rotation(angle * Vector3::Unit(axis)); }

/// The bones of one finger, one after the other.
class Chain {
 public:
  explicit Chain(const Pose& X_HB) : X_HB_(X_HB) {}
  void turn(const Matrix3& by) { X_HB_.rotation *= by; }
  /// Middle of the next bone; goes on to its end.
  Pose pass(double length) {
    const Vector3 half(0.5 * length, 0.0, 0.0);
    Pose middle{X_HB_.rotation, X_HB_ * half};
    X_HB_.translation = middle * half;
    return middle;
  }

 private:
  Pose X_HB_;
};

Pose mirrored(Pose pose) {
  const Vector3 across(1.0, -1.0, 1.0);
  pose.translation = across.cwiseProduct(pose.translation);
  pose.rotation = across.asDiagonal() * pose.rotation * across.asDiagonal();
  return pose;
}

/// X_HB where the finger's metacarpal begins.
Pose root_of(std::size_t finger, double size, const Vector3& angles) {
  const Root& root = kRoots.at(finger);
  const Vector3 place = size * root.place;
  if (finger != static_cast<std::size_t>(HandFinger::kThumb)) {
    return {about(2, root.spread), place};
  }
  // It bends across the palm, and in front of it once turned there.
  return {
      about(0, -angles[0]) * about(2, root.spread) * about(0, -90.0 * deg) * about(1, angles[1]),
      place};
}

}  // namespace

HandPose hand_pose(HandSide side, double size, const Pose& X_WH, const HandAngles& angles) {
  HandPose hand;
  std::size_t piece = 0;
  const auto place = [&](const Pose& X_HB) {
    return X_WH * (side == HandSide::kRight ? X_HB : mirrored(X_HB));
  };
  for (std::size_t f = 0; f < kHandFingers.size(); ++f) {
    const Vector3& turned = angles.at(f);
    const bool is_thumb = kHandFingers.at(f).value == HandFinger::kThumb;
    Chain chain(root_of(f, size, turned));
    const auto pass = [&] {
      hand.pieces.at(piece) = place(chain.pass(size * kHandPieces.at(piece).length));
      ++piece;
    };
    pass();
    chain.turn(is_thumb ? about(1, turned[2]) : Matrix3(about(2, turned[0]) * about(1, turned[1])));
    pass();
    chain.turn(about(1, turned[2]));
    if (!is_thumb) {
      pass();
      chain.turn(about(1, kLastJoint * turned[2]));
    }
    hand.distal.at(f) = place(chain.pass(size * kDistalLengths.at(f)));
  }
  return hand;
}

std::size_t joint_of(std::size_t piece) {
  // A joint before each bone, after the wrist; between the last bone here and the next finger's
  // first are the distal joint and the tip.
  std::size_t joint = 0;
  for (std::size_t p = 0; p <= piece; ++p) {
    joint += p > 0 && kHandPieces.at(p).bone == HandBone::kMetacarpal ? std::size_t{3} : 1;
  }
  return joint;
}

}  // namespace softfinger
