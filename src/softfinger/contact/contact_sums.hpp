#pragma once

#include <limits>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// What a contact set comes to as a whole. Contact sets, recorded steps and snapshots all have
/// these members. Vectors are expressed in F.
struct ContactSums {
  int contact_count = 0;          ///< members of C, features among them
  double contact_area = 0.0;      ///< of the deformed skin, see report_area(), m^2
  double normal_force = 0.0;      ///< magnitude of the sum of normal forces, N
  double normal_force_sum = 0.0;  ///< sum of the magnitudes of normal forces, N
  double tangential_force = 0.0;  ///< magnitude of the sum of tangential forces, N
  /// Magnitude of the summed tangential forces over the sum of mu times the normal forces: 0
  /// nothing pulls, 1 all of C slides one way. 0 without friction.
  double slip_ratio = 0.0;
  /// Part of C, by deformed area, that sticks; 0 without contact, and where nothing rubs.
  double stuck_fraction = 0.0;
  Vector3 centroid_F = Vector3::Zero();     ///< weighted by normal force, m; zero where C is empty
  Vector3 mean_normal_F = Vector3::Zero();  ///< direction of the summed normal forces, out of the
                                            ///< object; zero where C is empty
  Vector3 tangential_force_F = Vector3::Zero();  ///< sum of tangential forces, object on skin, N
  double least_gap = std::numeric_limits<double>::infinity();  ///< m; infinite without objects

  [[nodiscard]] ContactSums& sums() { return *this; }
  [[nodiscard]] const ContactSums& sums() const { return *this; }
};

}  // namespace softfinger
