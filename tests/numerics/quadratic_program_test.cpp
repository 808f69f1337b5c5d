#include "softfinger/numerics/quadratic_program.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

namespace softfinger {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// minimise 1/2 d^T B d + g^T d subject to c + A d <= 0.
struct Program {
  MatrixXd B;
  VectorXd g, c;
  MatrixXd A;
};

/// Solution of a square system by elimination with row pivots; nothing where it is singular.
std::optional<VectorXd> solved(MatrixXd m, VectorXd right) {
  for (Index k = 0; k < m.rows(); ++k) {
    Index pivot = k;
    for (Index i = k; i < m.rows(); ++i) {
      if (std::abs(m(i, k)) > std::abs(m(pivot, k))) pivot = i;
    }
    if (std::abs(m(pivot, k)) < 1e-9) return std::nullopt;
    m.row(k).swap(m.row(pivot));
    std::swap(right[k], right[pivot]);
    for (Index i = 0; i < m.rows(); ++i) {
      if (i == k) continue;
      const double factor = m(i, k) / m(k, k);
      m.row(i) -= factor * m.row(k);
      right[i] -= factor * right[k];
    }
  }
  for (Index k = 0; k < m.rows(); ++k) right[k] /= m(k, k);
  return right;
}

/// The minimum by trial of every set of active constraints; nothing where none is feasible.
std::optional<VectorXd> minimum_by_enumeration(const Program& program) {
  const Index n = program.g.size(), m = program.c.size();
  for (unsigned set = 0; set < 1u << m; ++set) {
    const Index count = std::popcount(set);
    if (count > n) continue;
    MatrixXd kkt = MatrixXd::Zero(n + count, n + count);
    VectorXd right(n + count);
    kkt.topLeftCorner(n, n) = program.B;
    right.head(n) = -program.g;
    for (Index k = 0, row = n; k < m; ++k) {
      if ((set >> k & 1u) == 0) continue;
      kkt.row(row).head(n) = program.A.row(k);
      kkt.col(row).head(n) = program.A.row(k).transpose();
      right[row++] = -program.c[k];
    }
    const std::optional<VectorXd> point = solved(kkt, right);
    if (!point) continue;
    const VectorXd d = point->head(n);
    if ((program.c + program.A * d).maxCoeff() > 1e-9) continue;
    if (count > 0 && point->tail(count).minCoeff() < -1e-9) continue;
    return d;
  }
  return std::nullopt;
}

/// The Karush-Kuhn-Tucker conditions, which only the minimum fulfils.
void expect_optimal(const Program& program, const QuadraticProgram& solver) {
  const VectorXd& d = solver.step();
  const VectorXd& lambda = solver.multipliers();
  const double size = 1.0 + lambda.maxCoeff();
  const VectorXd stationary = program.B * d + program.g + program.A.transpose() * lambda;
  const VectorXd slack = program.c + program.A * d;
  EXPECT_LT(stationary.cwiseAbs().maxCoeff(), 1e-9 * size);
  EXPECT_LT(slack.maxCoeff(), 1e-9);
  EXPECT_GE(lambda.minCoeff(), 0.0);
  EXPECT_LT(lambda.cwiseProduct(slack).cwiseAbs().maxCoeff(), 1e-9 * size);
}

/// Checks one program both ways; whether it had a solution.
bool check(const Program& program) {
  QuadraticProgram solver(static_cast<int>(program.g.size()), static_cast<int>(program.c.size()));
  EXPECT_TRUE(solver.factor(program.B));
  const bool feasible = solver.solve(program.g, program.c, program.A);
  const std::optional<VectorXd> expected = minimum_by_enumeration(program);
  EXPECT_EQ(feasible, expected.has_value());
  if (feasible && expected) {
    EXPECT_LT((solver.step() - *expected).cwiseAbs().maxCoeff(), 1e-8);
    expect_optimal(program, solver);
  }
  return feasible;
}

/// Entries from `draw`; B is positive definite.
template <typename Draw>
Program drawn(std::mt19937& random, Draw&& draw) {
  const auto n = std::uniform_int_distribution<Index>(1, 4)(random);
  const auto m = std::uniform_int_distribution<Index>(1, 6)(random);
  const auto fill = [&](Index rows, Index columns) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, columns, [&] { return draw(); }));
  };
  const MatrixXd root = fill(n, n);
  return {root.transpose() * root + 0.1 * MatrixXd::Identity(n, n), fill(n, 1), fill(m, 1),
          fill(m, n)};
}

TEST(QuadraticProgram, AgreesWithTheTrialOfEveryActiveSet) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  int feasible = 0, infeasible = 0;
  for (int k = 0; k < 400 && !testing::Test::HasFailure(); ++k) {
    SCOPED_TRACE(k);
    ++(check(drawn(random, [&] { return normal(random); })) ? feasible : infeasible);
  }
  EXPECT_GT(feasible, 100);
  EXPECT_GT(infeasible, 40);
}

// Small whole numbers: constraints that coincide, oppose each other, meet in one corner or are
// void (a zero row) are common.
TEST(QuadraticProgram, AgreesWhereConstraintsAreDegenerate) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> small(-1, 1);
  int feasible = 0, infeasible = 0;
  for (int k = 0; k < 400 && !testing::Test::HasFailure(); ++k) {
    SCOPED_TRACE(k);
    ++(check(drawn(random, [&] { return double(small(random)); })) ? feasible : infeasible);
  }
  EXPECT_GT(feasible, 100);
  EXPECT_GT(infeasible, 40);
}

TEST(QuadraticProgram, ScalesAsItsUnitsDo) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 50; ++k) {
    const Program program = drawn(random, [&] { return normal(random); });
    const int n = static_cast<int>(program.g.size()), m = static_cast<int>(program.c.size());
    QuadraticProgram plain(n, m), scaled(n, m);
    ASSERT_TRUE(plain.factor(program.B) && scaled.factor(1e6 * program.B));
    // Lengths a thousand times shorter, energies as they were.
    const bool feasible = plain.solve(program.g, program.c, program.A);
    ASSERT_EQ(scaled.solve(1e3 * program.g, 1e-3 * program.c, program.A), feasible);
    if (!feasible) continue;
    EXPECT_LT((1e3 * scaled.step() - plain.step()).norm(), 1e-9 * (1.0 + plain.step().norm()));
    EXPECT_LT((1e-3 * scaled.multipliers() - plain.multipliers()).norm(),
              1e-9 * (1.0 + plain.multipliers().norm()));
  }
}

TEST(QuadraticProgram, WithoutConstraintsItIsANewtonStep) {
  const Eigen::Matrix2d B{{4.0, 1.0}, {1.0, 3.0}};
  const Eigen::Vector2d g(-1.0, 2.0);
  QuadraticProgram solver(2, 0);
  ASSERT_TRUE(solver.factor(B));
  solver.solve(g);
  EXPECT_LT((B * solver.step() + g).norm(), 1e-15);
}

TEST(QuadraticProgram, RefusesWhatIsNotPositiveDefinite) {
  QuadraticProgram solver(2, 0);
  EXPECT_FALSE(solver.factor((MatrixXd(2, 2) << 1.0, 2.0, 2.0, 1.0).finished()));
  EXPECT_FALSE(solver.factor((MatrixXd(2, 2) << 1.0, 1.0, 1.0, 1.0).finished()));
  EXPECT_FALSE(solver.factor(MatrixXd::Zero(2, 2)));
  EXPECT_TRUE(solver.factor((MatrixXd(2, 2) << 1.0, 0.9, 0.9, 1.0).finished()));
}

}  // namespace
}  // namespace softfinger
