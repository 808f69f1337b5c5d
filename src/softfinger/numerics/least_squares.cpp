#include "softfinger/numerics/least_squares.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <numeric>
#include <vector>

namespace softfinger {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFirstDamping = 1e-3;
constexpr double kLeastDamping = 1e-9, kGreatestDamping = 1e9;
constexpr double kSmallStep = 5e-2;       // of the difference step
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

}  // namespace

VectorXd bounded_step(const LeastSquaresProblem& problem, const VectorXd& x,
                      const VectorXd& residuals, const MatrixXd& jacobian, double damping,
                      std::vector<Index> free) {
  MatrixXd normal = jacobian.transpose() * jacobian;
  // A floor, so that an unknown without influence does not make the matrix singular.
  const double floor = 1e-12 * normal.diagonal().maxCoeff() + 1e-300;
  normal.diagonal() += damping * normal.diagonal() + VectorXd::Constant(x.size(), floor);
  const VectorXd gradient = jacobian.transpose() * residuals;
  VectorXd step = VectorXd::Zero(x.size());
  while (!free.empty()) {
    VectorXd stopped = step;
    stopped(free).setZero();
    const VectorXd right = -gradient - normal * stopped;
    const VectorXd solved = MatrixXd(normal(free, free)).ldlt().solve(VectorXd(right(free)));
    step(free) = solved;
    const auto goes_out = [&](Index i) {
      const double wanted = x[i] + step[i];
      const double inside = std::clamp(wanted, problem.lower[i], problem.upper[i]);
      if (wanted == inside) return false;
      step[i] = inside - x[i];
      return true;
    };
    if (std::erase_if(free, goes_out) == 0) break;
  }
  return step;
}

LeastSquaresSolution minimise_squares(const LeastSquaresProblem& problem, const VectorXd& start,
                                      int max_iterations) {
  LeastSquaresSolution solution;
  solution.x = start.cwiseMax(problem.lower).cwiseMin(problem.upper);
  solution.residuals = problem.residuals(solution.x);
  if (solution.residuals.size() == 0 || !differentiate(problem, solution)) return solution;
  std::vector<Index> all(static_cast<std::size_t>(solution.x.size()));
  std::iota(all.begin(), all.end(), Index{0});
  VectorXd differentiated_at = solution.x;
  double damping = kFirstDamping;
  while (solution.iterations < max_iterations) {
    ++solution.iterations;
    const double cost = solution.sum_of_squares();
    const VectorXd wanted = solution.x + bounded_step(problem, solution.x, solution.residuals,
                                                      solution.jacobian, damping, all);
    const VectorXd x = wanted.cwiseMax(problem.lower).cwiseMin(problem.upper);
    const VectorXd step = x - solution.x;
    const double promised = cost - (solution.residuals + solution.jacobian * step).squaredNorm();
    const bool small = (step.array().abs() <= kSmallStep * problem.difference_step.array()).all();
    if (small || promised <= kSmallReduction * cost) {
      solution.converged = damping <= 1.0 || promised <= kUncertainReduction * cost;
      return solution;
    }
    const VectorXd residuals = problem.residuals(x);
    bool fresh = (differentiated_at.array() == solution.x.array()).all();
    if (residuals.size() > 0 && residuals.squaredNorm() < cost) {
      solution.x = x;
      solution.residuals = residuals;
      damping = std::max(damping / 10.0, kLeastDamping);
      // Within a difference step the Jacobian stays as good as it was.
      fresh = ((x - differentiated_at).array().abs() <= problem.difference_step.array()).all();
    } else if (fresh) {
      damping *= 5.0;
      if (damping > kGreatestDamping) {
        solution.converged = promised <= kUncertainReduction * cost;
        return solution;
      }
    }
    if (!fresh) {
      if (!differentiate(problem, solution)) return solution;
      differentiated_at = solution.x;
    }
  }
  return solution;
}

double student_t_quantile(double probability, double degrees_of_freedom) {
  // In doubles: more digits than anybody reads would take seconds to compile.
  using Doubles = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  return boost::math::quantile(
      boost::math::students_t_distribution<double, Doubles>(degrees_of_freedom), probability);
}

}  // namespace softfinger
