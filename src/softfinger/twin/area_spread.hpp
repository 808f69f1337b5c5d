#pragma once

#include <limits>

namespace softfinger {

/// How the area of contact grows with the normal force, m^2/N: what tells soft from hard (contact
/// area spread rate: Bicchi, Scilingo and De Rossi, "Haptic discrimination of softness in
/// teleoperation", IEEE Trans. Robotics and Automation 16(5), 2000). The slope of the line of least
/// squares through all that was added.
class AreaSpread {
 public:
  /// A moment in contact. N, m^2.
  void add(double normal_force, double area);
  /// NaN where the force varied by less than 0.05 N, its standard deviation.
  [[nodiscard]] double rate() const;

 private:
  // About the means so far (Welford), so that little is lost by rounding.
  double count_ = 0.0, mean_force_ = 0.0, mean_area_ = 0.0;
  double force_squares_ = 0.0, force_areas_ = 0.0;
};

}  // namespace softfinger
