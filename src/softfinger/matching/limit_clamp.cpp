#include "softfinger/matching/limit_clamp.hpp"

namespace softfinger {

Configuration last_reachable(const Device& device, const Configuration& from,
                             const Configuration& to) {
  constexpr int kPieces = 64;
  const auto at = [&](double fraction) { return Configuration(from + fraction * (to - from)); };
  double inside = 0.0;
  double outside = 1.0;
  bool left = false;
  for (int piece = 1; piece <= kPieces && !left; ++piece) {
    const double fraction = static_cast<double>(piece) / kPieces;
    if (device.reachable(at(fraction))) {
      inside = fraction;
    } else {
      outside = fraction;
      left = true;
    }
  }
  if (!left) return to;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (inside + outside);
    (device.reachable(at(middle)) ? inside : outside) = middle;
  }
  return at(inside);
}

Configuration clamped_to_limits(const Device& device, const Configuration& wanted) {
  if (device.reachable(wanted)) return wanted;
  JointAngles joints;
  device.clamped_joints(wanted, joints);
  Configuration q;
  if (device.forward_kinematics(joints, q)) return q;
  return last_reachable(device, device.home(), wanted);
}

}  // namespace softfinger
