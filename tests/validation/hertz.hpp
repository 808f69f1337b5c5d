#pragma once

#include <vector>

namespace softfinger::validation {

struct HertzRow {
  double depth = 0.0;        ///< m
  double force = 0.0;        ///< N
  double radius = 0.0;       ///< of the contact, from its area, m
  double hertz_force = 0.0;  ///< N, of a sphere on a half space
};
struct HertzPress {
  int tetrahedra = 0;
  int cells = 0;              ///< elements over the diameter
  double grading = 1.0;       ///< a radius r is reached by cells / 2 (r / R)^(1 / grading) elements
  double element_size = 0.0;  ///< at the pole, m
  std::vector<HertzRow> rows;
};
/// A half sphere of radius 10 mm, held at its equator and pressed on a rigid plane without friction
/// and limits, on meshes graded to the pole, coarse to fine.
[[nodiscard]] std::vector<HertzPress> hertz_presses();

}  // namespace softfinger::validation
