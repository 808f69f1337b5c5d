#pragma once

#include "softfinger/base/instruction_set.hpp"

namespace softfinger {

/// Tricubic B-splines at one point of a cell, one set per instruction set. `first` is the first of
/// 4 x 4 x 4 coefficients, x fastest, in rows of kSplineRow and planes of kSplineRow^2; `t`, each
/// in [0, 1], places the point in the cell. Derivatives are by t.
inline constexpr int kSplineRow = 11;

struct SplineKernels {
  /// f, f_x, f_y, f_z.
  void (*gradient)(const float* first, const double* t, double* out);
  /// f, f_x, f_y, f_z, f_xx, f_xy, f_xz, f_yy, f_yz, f_zz.
  void (*hessian)(const float* first, const double* t, double* out);
};

[[nodiscard]] const SplineKernels& spline_kernels(InstructionSet set);

}  // namespace softfinger
