#include "softfinger/tracking/stream/jump_gate.hpp"

#include <algorithm>

namespace softfinger {

bool JumpGate::within_reach(const Pose& X_WFt, double now) const {
  const double since = now - admitted_;
  const double distance = (X_WFt.translation - last_.translation).norm();
  const double turn = log_rotation(last_.rotation.transpose() * X_WFt.rotation).norm();
  return distance <= kMostNoise + kMostSpeed * since &&
         turn <= kMostTurnNoise + kMostTurnRate * since;
}

bool JumpGate::admits(const Pose& X_WFt, double now) {
  if (known_ && !within_reach(X_WFt, now)) {
    if (++doubt_ <= kMajority) return false;
    doubt_ = 0;
  } else {
    doubt_ = std::max(0, doubt_ - 1);
  }
  known_ = true;
  last_ = X_WFt;
  admitted_ = now;
  return true;
}

}  // namespace softfinger
