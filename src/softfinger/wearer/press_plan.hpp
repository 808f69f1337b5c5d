#pragma once

#include <memory>
#include <string>
#include <vector>

#include "softfinger/device/device.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// One press that a device is to do.
struct PlannedPress {
  Configuration tilted;  ///< where the device would be at home, turned
  double touch = 0.0;    ///< how far from there it is advanced where the model's skin is touched, m
  double most = 0.0;     ///< the furthest it can be advanced from there, m
  double pitch = 0.0, roll = 0.0;  ///< rad, of the surface's normal
  bool spare = false;              ///< left out where time is short
};

/// The presses that a device's freedom allows: level; turned by 15 degrees about either axis,
/// either way; and by 20 about both. Fewer for a device that turns about one axis, one for a device
/// that turns about none. In the order of short ways. Throws InputError (text only) for a device
/// that cannot advance, and for limits that forbid what its freedom allows: presses level and by 15
/// degrees, `depth` (m) beyond the resting skin.
[[nodiscard]] std::vector<PlannedPress> plan_presses(const Device& device,
                                                     const FingerModel& finger, double depth);

}  // namespace softfinger
