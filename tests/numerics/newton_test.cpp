#include "softfinger/numerics/newton.hpp"

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <vector>

namespace softfinger {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using testing::ElementsAre;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An energy with its derivatives; `projected` is what stands in for an indefinite Hessian.
struct Energy {
  double value = 0.0;
  Vector2d gradient = Vector2d::Zero();
  Matrix2d hessian = Matrix2d::Identity();
  Matrix2d projected = Matrix2d::Identity();
};
using Function = Energy (*)(const Vector2d&);

/// Two unknowns, and a diary of what was asked and accepted.
class Problem {
 public:
  Problem(Function function, const Vector2d& start)
      : function_(function), point(start), now_(function(start)) {}

  [[nodiscard]] double energy() const { return now_.value; }
  [[nodiscard]] double residual() const { return now_.gradient.norm(); }
  [[nodiscard]] bool has_factor() const { return has_factor_; }
  bool factorise(HessianKind kind) {
    tried.push_back(kind);
    factored_at.push_back(point);
    factor_ = kind == HessianKind::kProjected ? now_.projected : now_.hessian;
    has_factor_ = factor_(0, 0) > 0.0 && determinant() > 0.0;
    return has_factor_;
  }
  double solve_direction(bool /*refined*/) {
    const Vector2d& g = now_.gradient;
    direction_ = Vector2d(factor_(0, 1) * g.y() - factor_(1, 1) * g.x(),
                          factor_(1, 0) * g.x() - factor_(0, 0) * g.y()) /
                 determinant();
    return now_.gradient.dot(direction_);
  }
  void evaluate_trial(double t) {
    trial_point_ = point + t * direction_;
    trial_ = function_(trial_point_);
  }
  [[nodiscard]] double trial_energy() const { return trial_.value; }
  [[nodiscard]] double trial_residual() const { return trial_.gradient.norm(); }
  void accept_trial() {
    point = trial_point_;
    now_ = trial_;
    energies.push_back(now_.value);
    residuals.push_back(residual());
  }
  /// A factor from elsewhere, as a step begins with the last one's.
  void give_factor(const Matrix2d& factor) {
    factor_ = factor;
    has_factor_ = true;
  }

 private:
  [[nodiscard]] double determinant() const {
    return factor_(0, 0) * factor_(1, 1) - factor_(0, 1) * factor_(1, 0);
  }

  Function function_;

 public:
  Vector2d point;
  std::vector<double> energies, residuals;  ///< after each accepted trial
  std::vector<HessianKind> tried;
  std::vector<Vector2d> factored_at;

 private:
  Energy now_, trial_;
  Matrix2d factor_ = Matrix2d::Identity();
  Vector2d trial_point_ = Vector2d::Zero(), direction_ = Vector2d::Zero();
  bool has_factor_ = false;
};

/// Minimum at the origin, with third derivatives there.
Energy exponential(const Vector2d& p) {
  const double a = std::exp(p.x()), b = std::exp(p.y() - p.x());
  return {.value = a + b - p.y(),
          .gradient = {a - b, b - 1.0},
          .hessian = (Matrix2d() << a + b, -b, -b, b).finished()};
}

/// Convex, but so flat far away that a full step overshoots ever further from |x| > 1.
Energy hyperbola(const Vector2d& p) {
  const double rx = std::sqrt(1.0 + p.x() * p.x()), ry = std::sqrt(1.0 + 4.0 * p.y() * p.y());
  return {
      .value = rx + ry,
      .gradient = {p.x() / rx, 4.0 * p.y() / ry},
      .hessian = (Matrix2d() << 1.0 / (rx * rx * rx), 0.0, 0.0, 4.0 / (ry * ry * ry)).finished()};
}

/// Minima at (-1, 0) and (1, 0), a saddle between them.
Energy two_wells(const Vector2d& p) {
  const double s = p.x() * p.x() - 1.0;
  return {.value = 0.25 * s * s + 0.5 * p.y() * p.y(),
          .gradient = {p.x() * s, p.y()},
          .hessian = (Matrix2d() << 3.0 * p.x() * p.x() - 1.0, 0.0, 0.0, 1.0).finished()};
}

/// Minimum at (1, 0); there is no energy where x <= 0.
Energy barrier(const Vector2d& p) {
  if (p.x() <= 0.0) return {.value = kInfinity};
  return {.value = p.x() - std::log(p.x()) + 0.5 * p.y() * p.y(),
          .gradient = {1.0 - 1.0 / p.x(), p.y()},
          .hessian = (Matrix2d() << 1.0 / (p.x() * p.x()), 0.0, 0.0, 1.0).finished()};
}

NewtonOptions factor_always() { return {.tolerance = 1e-13, .chord_reduction = 1e300}; }

TEST(Newton, OneStepMinimisesAQuadratic) {
  Problem problem(
      [](const Vector2d& p) -> Energy {
        const Matrix2d K = (Matrix2d() << 5.0, 2.0, 2.0, 1.0).finished();
        const Vector2d r = p - Vector2d(3.0, -4.0);
        return {.value = 0.5 * r.dot(K * r), .gradient = K * r, .hessian = K};
      },
      {100.0, 70.0});
  const NewtonSummary summary = minimise(problem, {.tolerance = 1e-10});
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(summary.iterations, 1);
  EXPECT_EQ(summary.factorisations, 1);
  EXPECT_LT((problem.point - Vector2d(3.0, -4.0)).norm(), 1e-9);
}

TEST(Newton, ConvergesWithOrderTwo) {
  Problem problem(exponential, {0.3, -0.2});
  const NewtonSummary summary = minimise(problem, factor_always());
  EXPECT_TRUE(summary.converged);
  EXPECT_LT(problem.point.norm(), 1e-12);
  EXPECT_EQ(summary.factorisations, summary.iterations);
  EXPECT_EQ(summary.residual, problem.residual());
  const std::vector<double>& r = problem.residuals;
  int seen = 0;
  for (std::size_t k = 2; k < r.size() && r[k] > 1e-13; ++k, ++seen) {
    const double order = std::log(r[k] / r[k - 1]) / std::log(r[k - 1] / r[k - 2]);
    EXPECT_NEAR(order, 2.0, 0.3) << k;
  }
  EXPECT_GE(seen, 1);
}

TEST(Newton, ChordStepsTakeFewerFactors) {
  Problem problem(exponential, {0.1, -0.05});
  const NewtonSummary summary = minimise(problem, {.tolerance = 1e-12, .chord_reduction = 5.0});
  EXPECT_TRUE(summary.converged);
  EXPECT_LT(summary.factorisations, summary.iterations);
  EXPECT_LT(problem.point.norm(), 1e-11);
  // While a factor serves it keeps its promise, the last step of each apart.
  for (std::size_t k = 1; k < problem.residuals.size(); ++k) {
    EXPECT_LT(problem.residuals[k], problem.residuals[k - 1]);
  }
}

TEST(Newton, LineSearchComesInFromWhereFullStepsDiverge) {
  for (const Vector2d& start : {Vector2d(2.0, 1.0), Vector2d(-30.0, 8.0), Vector2d(1.5, -400.0)}) {
    Problem problem(hyperbola, start);
    double energy = problem.energy();
    const NewtonSummary summary = minimise(problem, factor_always());
    EXPECT_TRUE(summary.converged) << start.transpose();
    EXPECT_LT(problem.point.norm(), 1e-12);
    for (const double next : problem.energies) {
      EXPECT_LE(next, energy * (1.0 + 1e-10)) << start.transpose();
      energy = next;
    }
  }
}

TEST(Newton, StaysWhereTheEnergyIsFinite) {
  Problem problem(barrier, {3.0, 1.0});  // the full step goes to x = -3
  EXPECT_TRUE(minimise(problem, factor_always()).converged);
  EXPECT_LT((problem.point - Vector2d(1.0, 0.0)).norm(), 1e-12);
}

TEST(Newton, IndefiniteHessianGivesWayToTheProjectedOne) {
  Problem problem(two_wells, {0.2, 0.5});
  EXPECT_TRUE(minimise(problem, factor_always()).converged);
  EXPECT_LT((problem.point - Vector2d(1.0, 0.0)).norm(), 1e-12);
  ASSERT_GE(problem.tried.size(), 4u);
  EXPECT_THAT(
      std::vector(problem.tried.begin(), problem.tried.begin() + 3),
      ElementsAre(HessianKind::kFull, HessianKind::kNoContactCurvature, HessianKind::kProjected));
  EXPECT_EQ(problem.tried.back(), HessianKind::kFull) << "convex again: the best one again";
}

TEST(Newton, LeavesASaddleByLongSteps) {
  Problem problem(two_wells, {1e-9, 0.0});
  const NewtonSummary summary = minimise(problem, factor_always());
  EXPECT_TRUE(summary.converged);
  EXPECT_LT((problem.point - Vector2d(1.0, 0.0)).norm(), 1e-12);
  EXPECT_LT(summary.iterations, 15) << "unit steps double x: 30 of them";
}

TEST(Newton, EndsWhereNoHessianIsPositiveDefinite) {
  const Vector2d start(0.2, 0.5);
  Problem problem(
      [](const Vector2d& p) {
        Energy energy = two_wells(p);
        energy.projected = energy.hessian;
        return energy;
      },
      start);
  const NewtonSummary summary = minimise(problem, factor_always());
  EXPECT_FALSE(summary.converged);
  EXPECT_EQ(summary.iterations, 0);
  EXPECT_EQ(problem.point, start);
}

TEST(Newton, StopsOnCount) {
  for (const int most : {0, 1, 3}) {
    NewtonOptions options = factor_always();
    options.max_iterations = most;
    Problem problem(hyperbola, {30.0, 0.0});
    const NewtonSummary summary = minimise(problem, options);
    EXPECT_FALSE(summary.converged);
    EXPECT_EQ(summary.iterations, most);
    EXPECT_EQ(summary.residual, problem.residual());
  }
  Problem there(exponential, {0.0, 0.0});
  EXPECT_TRUE(minimise(there, {.max_iterations = 0}).converged);
}

TEST(Newton, OldFactorIsUsedWhereItServesAndReplacedWhereItMisleads) {
  Problem good(exponential, {0.01, 0.0});
  good.give_factor((Matrix2d() << 2.0, -1.0, -1.0, 1.0).finished());  // that of the minimum
  const NewtonSummary quick = minimise(good, {.tolerance = 1e-3});
  EXPECT_TRUE(quick.converged);
  EXPECT_EQ(quick.factorisations, 0);

  const Vector2d start(0.3, -0.2);
  Problem misled(exponential, start);
  misled.give_factor(-Matrix2d::Identity());  // uphill
  EXPECT_TRUE(minimise(misled, factor_always()).converged);
  ASSERT_FALSE(misled.factored_at.empty());
  EXPECT_EQ(misled.factored_at.front(), start) << "an uphill step is not taken";
  EXPECT_LT(misled.point.norm(), 1e-12);
}

}  // namespace
}  // namespace softfinger
