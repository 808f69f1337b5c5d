#include "softfinger/numerics/least_squares.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <vector>

namespace softfinger {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFirstDamping = 1e-3;
constexpr double kGreatestDamping = 1e9;
constexpr double kSmallStep = 1e-2;       // of the difference step
constexpr double kSmallReduction = 1e-9;  // of the sum of squares
// Differences are not exact: where they promise less than this, failing to find it is an end.
constexpr double kUncertainReduction = 1e-4;

/// Column i of the Jacobian; empty where neither side can be computed.
VectorXd column(const LeastSquaresProblem& problem, const VectorXd& x, const VectorXd& residuals,
                Index i) {
  const auto at = [&](double value) {
    if (value < problem.lower[i] || value > problem.upper[i]) return VectorXd();
    VectorXd moved = x;
    moved[i] = value;
    return problem.residuals(moved);
  };
  const double h = problem.difference_step[i];
  const VectorXd above = at(x[i] + h);
  const VectorXd below = at(x[i] - h);
  if (above.size() > 0 && below.size() > 0) return (above - below) / (2.0 * h);
  if (above.size() > 0) return (above - residuals) / h;
  if (below.size() > 0) return (residuals - below) / h;
  return {};
}

bool differentiate(const LeastSquaresProblem& problem, LeastSquaresSolution& solution) {
  solution.jacobian.resize(solution.residuals.size(), solution.x.size());
  for (Index i = 0; i < solution.x.size(); ++i) {
    const VectorXd derivative = column(problem, solution.x, solution.residuals, i);
    if (derivative.size() == 0) return false;
    solution.jacobian.col(i) = derivative;
  }
  return true;
}

/// The damped step over the unknowns that are not held at a bound; zero for the others.
VectorXd damped_step(const LeastSquaresProblem& problem, const LeastSquaresSolution& at,
                     double damping) {
  const VectorXd gradient = at.jacobian.transpose() * at.residuals;
  std::vector<Index> free;
  for (Index i = 0; i < at.x.size(); ++i) {
    const bool held = (at.x[i] <= problem.lower[i] && gradient[i] > 0.0) ||
                      (at.x[i] >= problem.upper[i] && gradient[i] < 0.0);
    if (!held) free.push_back(i);
  }
  VectorXd step = VectorXd::Zero(at.x.size());
  if (free.empty()) return step;
  MatrixXd normal = (at.jacobian.transpose() * at.jacobian)(free, free);
  // A floor, so that an unknown without influence does not make the matrix singular.
  const double floor = 1e-12 * normal.diagonal().maxCoeff() + 1e-300;
  normal.diagonal() +=
      damping * normal.diagonal().cwiseMax(floor) + VectorXd::Constant(normal.rows(), floor);
  step(free) = -normal.ldlt().solve(VectorXd(gradient(free)));
  return step;
}

}  // namespace

LeastSquaresSolution minimise_squares(const LeastSquaresProblem& problem, const VectorXd& start,
                                      int max_iterations) {
  LeastSquaresSolution solution;
  solution.x = start.cwiseMax(problem.lower).cwiseMin(problem.upper);
  solution.residuals = problem.residuals(solution.x);
  if (solution.residuals.size() == 0 || !differentiate(problem, solution)) return solution;
  double damping = kFirstDamping;
  while (solution.iterations < max_iterations) {
    ++solution.iterations;
    const double cost = solution.sum_of_squares();
    bool accepted = false;
    bool small = false;
    for (; !accepted; damping *= 5.0) {
      const VectorXd wanted = solution.x + damped_step(problem, solution, damping);
      const VectorXd x = wanted.cwiseMax(problem.lower).cwiseMin(problem.upper);
      const VectorXd step = x - solution.x;
      small = (step.array().abs() <= kSmallStep * problem.difference_step.array()).all();
      const double promised = cost - (solution.residuals + solution.jacobian * step).squaredNorm();
      if (small || promised <= kSmallReduction * cost) {
        solution.converged = true;
        return solution;
      }
      if (damping > kGreatestDamping) {
        solution.converged = promised <= kUncertainReduction * cost;
        return solution;
      }
      const VectorXd residuals = problem.residuals(x);
      if (residuals.size() == 0 || !(residuals.squaredNorm() < cost)) continue;
      solution.x = x;
      solution.residuals = residuals;
      accepted = true;
    }
    damping = std::max(damping / 50.0, 1e-9);
    if (!differentiate(problem, solution)) return solution;
  }
  return solution;
}

double student_t_quantile(double probability, double degrees_of_freedom) {
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), probability);
}

}  // namespace softfinger
