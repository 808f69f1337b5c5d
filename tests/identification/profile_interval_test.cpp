#include "softfinger/identification/profile_interval.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace softfinger {
namespace {

using Eigen::VectorXd;

LeastSquaresProblem problem_of(std::function<VectorXd(const VectorXd&)> residuals, Eigen::Index n,
                               double bound = 1e6) {
  return {std::move(residuals), VectorXd::Constant(n, -bound), VectorXd::Constant(n, bound),
          VectorXd::Constant(n, 1e-4)};
}

/// A straight line through five points, whose intervals any textbook's formula gives.
TEST(ProfileInterval, OfALineIsTheLinearisedOne) {
  const VectorXd t{{0.0, 1.0, 2.0, 3.0, 4.0}};
  const VectorXd y{{1.1, 2.9, 5.2, 6.8, 9.1}};
  const auto problem = problem_of(
      [&](const VectorXd& x) { return VectorXd(x[0] + x[1] * t.array() - y.array()); }, 2);
  const auto solution = minimise_squares(problem, VectorXd::Zero(2));
  const double spread = (t.array() - t.mean()).square().sum();
  const double slope = ((t.array() - t.mean()) * y.array()).sum() / spread;
  const double intercept = y.mean() - slope * t.mean();
  const double s = std::sqrt((intercept + slope * t.array() - y.array()).square().sum() / 3.0);
  const double half = 3.182446305 * s / std::sqrt(spread);
  const ConfidenceInterval interval = profile_interval(problem, solution, 1);
  EXPECT_NEAR(solution.x[1], slope, 1e-5);
  EXPECT_NEAR(interval.low, slope - half, 1e-3 * half);
  EXPECT_NEAR(interval.high, slope + half, 1e-3 * half);
  EXPECT_FALSE(interval.low_is_open || interval.high_is_open);
}

TEST(ProfileInterval, IsOpenWhereTheDataTellNothing) {
  // exp(-x) t: data of nearly nothing do not bound x from above.
  auto problem = problem_of(
      [](const VectorXd& x) {
        const VectorXd y{{0.02, -0.03, 0.01, 0.02, -0.01}};
        return VectorXd(std::exp(-x[0]) * VectorXd::LinSpaced(5, 0.2, 1.0) - y);
      },
      1, 10.0);
  const auto solution = minimise_squares(problem, VectorXd{{2.0}});
  const ConfidenceInterval interval = profile_interval(problem, solution, 0);
  EXPECT_TRUE(interval.high_is_open);
  EXPECT_FALSE(interval.low_is_open);
}

}  // namespace
}  // namespace softfinger
