#pragma once

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// An object as it is and moves at the end of a step, W.
struct ObjectState {
  Pose X_WO;
  Vector3 velocity = Vector3::Zero();          ///< of the centre of mass, m/s
  Vector3 angular_velocity = Vector3::Zero();  ///< rad/s
  double joint = 0.0;                          ///< q of slider (m) or hinge (rad)
  bool has_joint = false;                      ///< a slider or hinge
};

}  // namespace softfinger
