#include "softfinger/numerics/small_sparse_lu.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace softfinger {
namespace {

using SparseLu = SmallSparseLu<48>;

/// Regular, with about `density` of its entries.
SparseLu::Matrix random_sparse(std::mt19937& random, int size, double density) {
  std::normal_distribution<double> entry;
  std::uniform_real_distribution<double> part;
  std::vector<int> place(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) place[static_cast<std::size_t>(i)] = i;
  std::shuffle(place.begin(), place.end(), random);
  SparseLu::Matrix matrix = SparseLu::Matrix::Zero(size, size);
  for (double& value : matrix.reshaped()) value = part(random) < density ? entry(random) : 0.0;
  for (int i = 0; i < size; ++i) matrix(i, place[static_cast<std::size_t>(i)]) += 4.0;
  return matrix;
}

// Against Eigen's dense factors with full pivoting.
TEST(SmallSparseLu, SolvesBothWaysAndTellsTheDeterminant) {
  std::mt19937 random(1);
  std::normal_distribution<double> entry;
  for (const double density : {0.0, 0.05, 0.2, 1.0}) {
    for (int size = 1; size <= 48; ++size) {
      const SparseLu::Matrix matrix = random_sparse(random, size, density);
      Eigen::VectorXd b(size);
      for (double& value : b) value = entry(random);
      SparseLu lu;
      ASSERT_TRUE(lu.factor(matrix)) << size << " " << density;
      Eigen::VectorXd x = b;
      lu.solve(x);
      Eigen::VectorXd y = b;
      lu.solve_transposed(y);
      const double determinant = Eigen::MatrixXd(matrix).fullPivLu().determinant();
      EXPECT_LT((matrix * x - b).norm(), 1e-11 * (1.0 + x.norm())) << size << " " << density;
      EXPECT_LT((matrix.transpose() * y - b).norm(), 1e-11 * (1.0 + y.norm())) << size;
      EXPECT_NEAR(lu.determinant(), determinant, 1e-10 * std::abs(determinant)) << size;
    }
  }
}

// Six legs of three columns share six columns: nothing else comes to be.
TEST(SmallSparseLu, KeepsApartWhatIsApart) {
  std::mt19937 random(2);
  std::normal_distribution<double> entry;
  SparseLu::Matrix matrix = SparseLu::Matrix::Zero(24, 24);
  const auto fill = [&](int row, int column, int rows, int columns) {
    for (double& value : matrix.block(row, column, rows, columns).reshaped()) value = entry(random);
  };
  for (int leg = 0; leg < 6; ++leg) {
    fill(3 * leg, 6 + 3 * leg, 3, 3);
    fill(3 * leg, 0, 3, 6);
  }
  fill(18, 0, 6, 6);
  SparseLu lu;
  ASSERT_TRUE(lu.factor(matrix));
  EXPECT_EQ(lu.entry_count(), (matrix.array() != 0.0).count());
  double product = matrix.block<6, 6>(18, 0).determinant();
  for (int leg = 0; leg < 6; ++leg)
    product *= matrix.block<3, 3>(3 * leg, 6 + 3 * leg).determinant();
  EXPECT_NEAR(std::abs(lu.determinant()), std::abs(product), 1e-12 * std::abs(product));
}

TEST(SmallSparseLu, RefusesWhatHasNoSolution) {
  SparseLu lu;
  SparseLu::Matrix matrix = SparseLu::Matrix::Zero(3, 3);
  matrix(0, 1) = 2.0;
  matrix(2, 0) = 1.0;
  EXPECT_FALSE(lu.factor(matrix));
  EXPECT_EQ(lu.determinant(), 0.0);
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    matrix(1, 2) = value;
    EXPECT_FALSE(lu.factor(matrix));
    EXPECT_EQ(lu.determinant(), 0.0);
  }
  matrix(1, 2) = 3.0;
  EXPECT_TRUE(lu.factor(matrix));
  EXPECT_EQ(lu.determinant(), 6.0);
}

}  // namespace
}  // namespace softfinger
