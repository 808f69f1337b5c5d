#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace softfinger {

/// A small nonlinear least-squares problem with bounds: minimise |r(x)|^2, lower <= x <= upper.
struct LeastSquaresProblem {
  /// Residuals at x; an empty vector where they cannot be computed.
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> residuals;
  Eigen::VectorXd lower, upper;
  /// Steps of the central differences, one an unknown: also what counts as a small change of it.
  Eigen::VectorXd difference_step;
};

struct LeastSquaresSolution {
  Eigen::VectorXd x;
  Eigen::VectorXd residuals;  ///< at x
  Eigen::MatrixXd jacobian;   ///< dr/dx at x, or within a difference step of it
  int iterations = 0;
  bool converged = false;
  [[nodiscard]] double sum_of_squares() const { return residuals.squaredNorm(); }
};

/// Levenberg-Marquardt (Marquardt, "An algorithm for least-squares estimation of nonlinear
/// parameters", SIAM J. Appl. Math. 1963) with central differences, one-sided at bounds; unknowns
/// whose gradient points out of their bound rest there. For few unknowns and costly residuals.
/// `start` is clamped to the bounds. Where the residuals cannot be computed at the start, the
/// solution has no residuals and has not converged.
[[nodiscard]] LeastSquaresSolution minimise_squares(const LeastSquaresProblem& problem,
                                                    const Eigen::VectorXd& start,
                                                    int max_iterations = 100);

/// Gauss-Newton step from x, damped by `damping` times the diagonal, over the unknowns `free` and
/// zero for the others. Unknowns that it would take out of their bounds stop there, and the rest is
/// solved for anew.
[[nodiscard]] Eigen::VectorXd bounded_step(const LeastSquaresProblem& problem,
                                           const Eigen::VectorXd& x,
                                           const Eigen::VectorXd& residuals,
                                           const Eigen::MatrixXd& jacobian, double damping,
                                           std::vector<Eigen::Index> free);

/// Quantile of Student's t distribution, probability in (0, 1), degrees of freedom at least 1.
[[nodiscard]] double student_t_quantile(double probability, double degrees_of_freedom);

}  // namespace softfinger
