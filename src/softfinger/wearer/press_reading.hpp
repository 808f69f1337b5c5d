#pragma once

#include <vector>

#include "softfinger/device/configuration.hpp"

namespace softfinger {

/// One reading of a force sensor while a device is pressed on.
struct PressReading {
  Configuration q;     ///< where the device stood
  double force = 0.0;  ///< N
  double count = 1.0;  ///< how many readings it is the mean of
  double time = 0.0;   ///< s
};

/// The readings of one press as the device advances: from one tilt, along one line of q.
struct PressRecord {
  Configuration start;  ///< off the skin
  /// From there to the first that counts, faster: skin that relaxes remembers them.
  std::vector<PressReading> approach;
  std::vector<PressReading> readings;
};

/// Force of a flat surface at which a wearer feels it, N; a guess. What it, and the time until it
/// is told, are wrong by is alike in all touches, and taken for a place of the mount.
inline constexpr double kFeltForce = 0.02;

/// Where a wearer felt a device that was advanced from `start`, m.
struct TouchRecord {
  Configuration start;
  double advance = 0.0;
};

}  // namespace softfinger
