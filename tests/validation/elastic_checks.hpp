#pragma once

#include <vector>

namespace softfinger::validation {

struct PatchTest {
  int tetrahedra = 0;
  int free_nodes = 0;
  double strain = 0.0;
  double error = 0.0;  ///< m, farthest interior node from the affine map
};
/// Boundary nodes of a block follow an affine map (stretch, shear, rotation); the interior must,
/// too.
[[nodiscard]] std::vector<PatchTest> patch_tests();

struct Invariance {
  double energy = 0.0;      ///< relative change under rotation and translation
  double forces = 0.0;      ///< largest change of the turned forces, over the largest force
  double net_force = 0.0;   ///< over the largest nodal force
  double net_torque = 0.0;  ///< over the largest nodal force times the block's size
  double gradient = 0.0;    ///< against central differences of the energy, over the largest force
};
/// Of a deformed block with strain limits.
[[nodiscard]] Invariance invariance();

struct Cantilever {
  int elements_over_height = 0;
  int tetrahedra = 0;
  double poissons_ratio = 0.0;
  double deflection = 0.0;  ///< over that of Timoshenko's beam
};
/// Beam of 10 x 1 x 1, clamped at one end, small load at the other.
[[nodiscard]] std::vector<Cantilever> cantilevers();

}  // namespace softfinger::validation
