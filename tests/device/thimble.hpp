#pragma once

#include <cmath>
#include <memory>
#include <random>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/device/kinds/platform_3rrs.hpp"

namespace softfinger {

/// The shipped device, loaded once.
inline const Device& thimble() {
  static const std::shared_ptr<const Device> device =
      load_device(source_folder() + "/devices/thimble-3rrs.toml");
  return *device;
}
inline const Platform3rrs& thimble_legs() {
  return dynamic_cast<const Platform3rrs&>(thimble().kinematics());
}

inline Configuration configuration(double pitch_deg, double roll_deg, double travel_mm) {
  Configuration q(3);
  q << pitch_deg * deg, roll_deg * deg, travel_mm * mm;
  return q;
}

/// A configuration drawn from the workspace.
inline Configuration random_reachable(std::mt19937& random) {
  std::uniform_real_distribution<double> tilt(-30.0, 30.0);
  std::uniform_real_distribution<double> travel(-8.0, 13.0);
  for (;;) {
    const Configuration q = configuration(tilt(random), tilt(random), travel(random));
    if (thimble().reachable(q)) return q;
  }
}

/// Steps for central differences of q.
inline Eigen::Vector3d difference_steps() { return {1e-6, 1e-6, 1e-8}; }

}  // namespace softfinger
