#pragma once

#include <Eigen/Core>
#include <vector>

namespace softfinger {

/// Small dense strictly convex quadratic programs
///   minimise 1/2 d^T B d + g^T d   subject to   c + A d <= 0
/// by the dual active-set method of Goldfarb and Idnani (Mathematical Programming 27, 1983, 1-33).
/// Made for few constraints active at once. Allocates only in the constructor.
class QuadraticProgram {
 public:
  QuadraticProgram(int variables, int constraints);

  /// Cholesky factor of B; false unless B is positive definite (then the old factor is gone).
  [[nodiscard]] bool factor(const Eigen::MatrixXd& B);
  /// Solves with the last factor. False where the constraints contradict each other; step() is then
  /// the last point of the dual method, not feasible.
  [[nodiscard]] bool solve(const Eigen::VectorXd& g, const Eigen::VectorXd& c,
                           const Eigen::MatrixXd& A);
  /// The same without constraints.
  void solve(const Eigen::VectorXd& g);

  [[nodiscard]] const Eigen::VectorXd& step() const { return step_; }
  /// One per constraint, >= 0; zero for those not active.
  [[nodiscard]] const Eigen::VectorXd& multipliers() const { return multipliers_; }

 private:
  void apply_inverse(Eigen::Ref<Eigen::VectorXd> vector) const;
  /// Coefficients r that best combine the active rows into row p (in the metric of B^-1).
  void combine_active(int p, const Eigen::MatrixXd& A);

  int variables_;
  Eigen::MatrixXd factor_;  ///< lower
  Eigen::VectorXd step_, multipliers_;
  std::vector<int> active_;
  Eigen::MatrixXd inverse_rows_;  ///< B^-1 a of the active constraints, by column
  Eigen::VectorXd direction_, combination_;
  Eigen::MatrixXd gram_;
};

}  // namespace softfinger
