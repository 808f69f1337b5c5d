#include "softfinger/actuation/servo_lag.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {

ServoLag::ServoLag(Eigen::Index joints, double least_motion)
    : least_motion_(least_motion), told_(kKept, Told{.joints = JointAngles::Zero(joints)}) {}

void ServoLag::sent(double time, const JointAngles& joints) {
  told_[next_] = {time, joints};
  next_ = (next_ + 1) % kKept;
  count_ = std::min(count_ + 1, kKept);
}

std::size_t ServoLag::one_way(Eigen::Index joint) const {
  const auto motion = [&](std::size_t age) {
    return told(age).joints[joint] - told(age + 1).joints[joint];
  };
  std::size_t age = 0;
  while (age + 1 < count_ && motion(0) * motion(age) > 0.0) ++age;
  return age;
}

std::optional<double> ServoLag::seen(double time, const JointAngles& joints) const {
  std::optional<Eigen::Index> furthest;
  double motion = least_motion_;
  for (Eigen::Index joint = 0; joint < joints.size(); ++joint) {
    const double moved = std::abs(told(0).joints[joint] - told(one_way(joint)).joints[joint]);
    if (moved < motion) continue;
    furthest = joint;
    motion = moved;
  }
  if (!furthest) return std::nullopt;
  const std::size_t oldest = one_way(*furthest);
  for (std::size_t age = 0; age < oldest; ++age) {
    const Told& later = told(age);
    const Told& earlier = told(age + 1);
    const double way = later.joints[*furthest] - earlier.joints[*furthest];
    const double fraction = (joints[*furthest] - earlier.joints[*furthest]) / way;
    if (fraction < 0.0) continue;
    if (fraction > 1.0) return std::nullopt;  // past the newest
    const double lag = time - (earlier.time + fraction * (later.time - earlier.time));
    return lag >= 0.0 ? std::optional(lag) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace softfinger
