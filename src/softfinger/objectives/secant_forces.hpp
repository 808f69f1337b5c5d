#pragma once

#include "softfinger/device/device.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {

/// What the twin feels around a configuration: forces there and their derivatives, which learn from
/// what is felt elsewhere.
struct SecantForces {
  TwinForces forces;
  bool doubtful = false;  ///< the derivatives have misled since they were derived

  /// Changes the derivatives, as little as does it, so that they tell the forces felt `step` (by q,
  /// not zero) away; F, N. Least is meant in the metric of the device's axes (Broyden, "A class of
  /// methods for solving nonlinear simultaneous equations", Math. Comp. 1965). Skin meets a device
  /// a little more with every few micrometres: a derivative is right where it was derived, a secant
  /// over the length of a step. Returns whether the normal force was foretold, by and large.
  bool learn(const Device& device, const Configuration& step, const Vector3& normal,
             const Vector3& tangential);
};

}  // namespace softfinger
