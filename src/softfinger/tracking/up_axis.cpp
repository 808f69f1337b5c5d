#include "softfinger/tracking/up_axis.hpp"

namespace softfinger {
namespace {

/// Q, from a y-up K to W.
Matrix3 y_up_to_world() {
  Matrix3 q;
  q << 0.0, 0.0, -1.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  return q;
}

Pose turned(const Matrix3& q, const Pose& pose) {
  return {q * pose.rotation * q.transpose(), q * pose.translation};
}

}  // namespace

Pose world_from_tracker(UpAxis up, const Pose& X_KBody) {
  return up == UpAxis::kZ ? X_KBody : turned(y_up_to_world(), X_KBody);
}

Pose tracker_from_world(UpAxis up, const Pose& X_WBody) {
  return up == UpAxis::kZ ? X_WBody : turned(y_up_to_world().transpose(), X_WBody);
}

}  // namespace softfinger
