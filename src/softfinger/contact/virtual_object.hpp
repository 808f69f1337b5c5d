#pragma once

#include <optional>
#include <string>

#include "softfinger/contact/object_dynamics.hpp"
#include "softfinger/geometry/signed_distance.hpp"
#include "softfinger/geometry/trajectory.hpp"

namespace softfinger {

/// A rigid thing that can be touched. Its frame is O; the motion gives X_WO over time, or where it
/// has dynamics, at the start.
struct VirtualObject {
  std::string name;
  Shape shape;
  Trajectory motion;
  std::optional<double> friction_coefficient;   ///< the finger's where empty
  std::optional<ObjectDynamics> dynamics = {};  ///< absent: it follows its motion
};

}  // namespace softfinger
