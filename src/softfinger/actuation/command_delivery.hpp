#pragma once

#include <limits>

namespace softfinger {

/// What the way from a formed command to the servos took, s; NaN where it is not known.
struct CommandDelivery {
  double send = std::numeric_limits<double>::quiet_NaN();   ///< from formed to written to the port
  double servo = std::numeric_limits<double>::quiet_NaN();  ///< see ServoLag
};

}  // namespace softfinger
