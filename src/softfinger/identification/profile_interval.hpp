#pragma once

#include "softfinger/numerics/least_squares.hpp"

namespace softfinger {

/// Confidence interval of one unknown of a least-squares fit.
struct ConfidenceInterval {
  double low = 0.0, high = 0.0;
  bool low_is_open = false,
       high_is_open = false;  ///< the bound was reached before the interval's end
};

/// Interval of unknown i whose ends raise the sum of squares, the others being fitted anew, by
/// s^2 t^2, with s^2 estimated from the residuals and t the two-sided quantile of Student's t at
/// `level` (Bates and Watts, "Nonlinear Regression Analysis and Its Applications", 1988, section
/// 6.1.2). It starts from the linearised interval, x_i +- t s sqrt((J^T J)^-1_ii), and is that
/// interval where the residuals are linear. Needs more residuals than unknowns.
[[nodiscard]] ConfidenceInterval profile_interval(const LeastSquaresProblem& problem,
                                                  const LeastSquaresSolution& solution,
                                                  Eigen::Index i, double level = 0.95);

}  // namespace softfinger
