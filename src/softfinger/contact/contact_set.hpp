#pragma once

#include <limits>
#include <vector>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// One skin sample (a vertex of the mesh group `skin`) against the object nearest to it.
/// Vectors are expressed in F, the simulated distal phalanx.
struct ContactSample {
  Vector3 position_F = Vector3::Zero();                  ///< deformed position, m
  Vector3 normal_F = Vector3::UnitZ();                   ///< unit, out of the object
  double gap = std::numeric_limits<double>::infinity();  ///< signed distance to the object, m
  double normal_force = 0.0;                             ///< |normal_force_F|, N
  Vector3 normal_force_F =
      Vector3::Zero();  ///< N, object on skin, with what features near it carry
  Vector3 tangential_force_F = Vector3::Zero();  ///< N, object on skin, likewise
  double rest_area = 0.0;                        ///< a third of its skin triangles at rest, m^2
  double area = 0.0;                             ///< the same, deformed, m^2
  double friction_limit = 0.0;                   ///< mu times the normal force, N
  bool slides = false;                           ///< tangential force at its limit
  bool in_contact = false;                       ///< member of C (else of N)
  int object = -1;  ///< index of the nearest object, -1 if there is none
};

/// The paper's sets C and N over all skin samples, with their sums.
/// A sample is in C when its gap is at most the finger's tolerance and its normal force exceeds
/// 1e-6 N.
struct ContactSet {
  std::vector<ContactSample> samples;
  int contact_count = 0;
  double contact_area = 0.0;      ///< deformed area of C, m^2
  double normal_force = 0.0;      ///< magnitude of the sum of normal forces, N
  double normal_force_sum = 0.0;  ///< sum of the magnitudes of normal forces, N
  double tangential_force = 0.0;  ///< magnitude of the sum of tangential forces, N
  /// Magnitude of the summed tangential forces over the sum of mu times the normal forces: 0
  /// nothing pulls, 1 all of C slides one way. 0 without friction.
  double slip_ratio = 0.0;
  /// Part of C, by deformed area, that sticks; 0 without contact, and where nothing rubs.
  double stuck_fraction = 0.0;
  /// Of the obstacle at the sample with the greatest normal force; of the last one touched where C
  /// is empty, at first the finger's.
  double friction_coefficient = 0.0;
  Vector3 centroid_F = Vector3::Zero();  ///< weighted by normal force, m; zero where C is empty
  Vector3 mean_normal_F =
      Vector3::Zero();  ///< direction of the summed normal forces; zero where C is empty
  double least_gap = std::numeric_limits<double>::infinity();  ///< m
  Vector3 nearest_normal_F = Vector3::UnitZ();  ///< object's normal at the sample of least gap
};

}  // namespace softfinger
