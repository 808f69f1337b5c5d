#include "softfinger/actuation/servo_lag.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {

ServoLag::ServoLag(Eigen::Index joints, double least_motion)
    : least_motion_(least_motion), told_(kKept, Told{0.0, JointAngles::Zero(joints)}) {}

void ServoLag::sent(double time, const JointAngles& joints) {
  told_[next_] = {time, joints};
  next_ = (next_ + 1) % kKept;
  count_ = std::min(count_ + 1, kKept);
}

std::size_t ServoLag::one_way(Eigen::Index joint) const {
  if (count_ < 2) return 0;
  const double last = told(0).joints[joint] - told(1).joints[joint];
  std::size_t age = 0;
  while (age + 1 < count_ && last * (told(age).joints[joint] - told(age + 1).joints[joint]) > 0.0) {
    ++age;
  }
  return age;
}

std::optional<double> ServoLag::seen(double time, const JointAngles& joints) const {
  Eigen::Index furthest = -1;
  std::size_t oldest = 0;
  double motion = least_motion_;
  for (Eigen::Index joint = 0; joint < joints.size(); ++joint) {
    const std::size_t age = one_way(joint);
    const double moved = std::abs(told(0).joints[joint] - told(age).joints[joint]);
    if (age == 0 || moved < motion) continue;
    furthest = joint;
    oldest = age;
    motion = moved;
  }
  if (furthest < 0) return std::nullopt;
  for (std::size_t age = 0; age < oldest; ++age) {
    const Told& later = told(age);
    const Told& earlier = told(age + 1);
    const double way = later.joints[furthest] - earlier.joints[furthest];
    const double fraction = (joints[furthest] - earlier.joints[furthest]) / way;
    if (fraction < 0.0) continue;
    if (fraction > 1.0) return std::nullopt;  // past the newest
    const double lag = time - (earlier.time + fraction * (later.time - earlier.time));
    return lag >= 0.0 ? std::optional(lag) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace softfinger
