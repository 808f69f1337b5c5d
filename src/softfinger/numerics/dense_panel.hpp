#pragma once

#include "softfinger/base/instruction_set.hpp"

namespace softfinger {

/// Dense kernels on column-major panels of floats, one set per instruction set. Panels have a
/// leading dimension that is a multiple of kPanelAlignment and start on that alignment, so that
/// kernels may read and write whole vectors past the last row.
inline constexpr int kPanelAlignment = 8;
/// Right-hand sides that are solved at once: the panel is read from memory once for all.
inline constexpr unsigned kTogether = 3;

struct DensePanelKernels {
  /// Factors the panel's leading columns x columns block as L L^T and solves the rows below by it.
  /// The diagonal of L is kept as its inverse. Returns false at the first pivot that is not
  /// positive.
  bool (*factor)(float* panel, int rows, int columns, int stride);
  /// out (rows x columns, stride out_stride) = lower part of A B^T, where A is rows x depth at `a`
  /// and B its first `columns` rows; both have stride a_stride.
  void (*outer_product)(const float* a, int a_stride, int rows, int columns, int depth, float* out,
                        int out_stride);
  using Solve = void (*)(const float* panel, int rows, int columns, int stride, float* t,
                         int t_stride);
  /// t = panel^-1 t for the leading block, then subtracts the rows below times it from the rest of
  /// t. For one vector (t_stride is unused), and for kTogether of them, t_stride apart, each with
  /// the same bits as alone.
  Solve solve_forward, solve_forward_together;
  /// The transpose of solve_forward: needs the rest of t solved already.
  Solve solve_backward, solve_backward_together;
};

[[nodiscard]] const DensePanelKernels& dense_panel_kernels(InstructionSet set);

}  // namespace softfinger
