#pragma once

#include <optional>
#include <string>

#include "softfinger/geometry/signed_distance.hpp"
#include "softfinger/geometry/trajectory.hpp"

namespace softfinger {

/// A rigid thing that can be touched. Its frame is O; the motion gives X_WO over time.
struct VirtualObject {
  std::string name;
  Shape shape;
  Trajectory motion;
  std::optional<double> friction_coefficient;  ///< the finger's where empty
};

}  // namespace softfinger
