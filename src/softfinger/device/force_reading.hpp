#pragma once

#include "softfinger/device/configuration.hpp"

namespace softfinger {

/// What a device's force sensor says: the normal force on the wearer's finger, N, and where the
/// device stood then.
struct ForceReading {
  double normal_force = 0.0;
  Configuration configuration;
};

}  // namespace softfinger
