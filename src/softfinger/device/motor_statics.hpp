#pragma once

namespace softfinger {

/// `[statics]` of a device file: what its motors, all alike, are like under load.
struct MotorStatics {
  double holding = 0.0;     ///< the most that a motor holds, N m, or N for linear ones; 0: anything
  double compliance = 0.0;  ///< of motor and gears, rad by N m, or m by N
  double backlash = 0.0;    ///< play from end to end, rad, or m
};

}  // namespace softfinger
