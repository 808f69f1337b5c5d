#include "softfinger/numerics/least_squares.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace softfinger {
namespace {

using Eigen::VectorXd;

LeastSquaresProblem problem_of(std::function<VectorXd(const VectorXd&)> residuals, Eigen::Index n,
                               double bound = 1e6) {
  return {std::move(residuals), VectorXd::Constant(n, -bound), VectorXd::Constant(n, bound),
          VectorXd::Constant(n, 1e-4)};
}

TEST(StudentT, QuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(student_t_quantile(0.975, 1), 12.7062, 1e-4);
  EXPECT_NEAR(student_t_quantile(0.975, 10), 2.2281, 1e-4);
  EXPECT_NEAR(student_t_quantile(0.975, 27), 2.0518, 1e-4);
  EXPECT_NEAR(student_t_quantile(0.5, 3), 0.0, 1e-12);
}

TEST(LeastSquares, FindsTheMinimumOfRosenbrocksValley) {
  const auto problem = problem_of(
      [](const VectorXd& x) {
        return VectorXd{{10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]}};
      },
      2);
  const auto solution = minimise_squares(problem, VectorXd{{-1.2, 1.0}}, 400);
  EXPECT_TRUE(solution.converged);
  EXPECT_NEAR(solution.x[0], 1.0, 1e-4);
  EXPECT_NEAR(solution.x[1], 1.0, 1e-4);
}

TEST(LeastSquares, StopsAtABoundAndSolvesTheOthersAnew) {
  // Minimum of (x + y - 4)^2 + (x - y)^2 is (2, 2); with x <= 1 it is (1, 2).
  auto problem = problem_of(
      [](const VectorXd& x) {
        return VectorXd{{x[0] + x[1] - 4.0, x[0] - x[1]}};
      },
      2);
  problem.upper[0] = 1.0;
  const auto solution = minimise_squares(problem, VectorXd{{-3.0, 9.0}});
  EXPECT_TRUE(solution.converged);
  EXPECT_NEAR(solution.x[0], 1.0, 1e-9);
  EXPECT_NEAR(solution.x[1], 2.0, 1e-4);
}

TEST(LeastSquares, GoesAroundWhereNothingCanBeComputed) {
  const auto problem = problem_of(
      [](const VectorXd& x) -> VectorXd {
        if (x[0] <= 0.0) return {};
        return VectorXd{{std::log(x[0]) - 1.0, 0.1 * (x[0] - std::numbers::e)}};
      },
      1);
  // The first full step from 8 would lead below 0.
  const auto solution = minimise_squares(problem, VectorXd{{40.0}});
  EXPECT_TRUE(solution.converged);
  EXPECT_NEAR(solution.x[0], std::numbers::e, 1e-4);
  EXPECT_EQ(minimise_squares(problem, VectorXd{{-1.0}}).residuals.size(), 0);
}

}  // namespace
}  // namespace softfinger
