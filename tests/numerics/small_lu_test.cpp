#include "softfinger/numerics/small_lu.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace softfinger {
namespace {

using Lu = SmallLu<24>;

Lu::Matrix random_matrix(std::mt19937& random, Eigen::Index size) {
  std::normal_distribution<double> entry;
  Lu::Matrix matrix(size, size);
  for (double& value : matrix.reshaped()) value = entry(random);
  return matrix;
}

TEST(SmallLu, SolvesBothWaysAndTellsTheDeterminant) {
  std::mt19937 random(1);
  for (Eigen::Index size = 1; size <= 24; ++size) {
    const Lu::Matrix matrix = random_matrix(random, size);
    const Eigen::VectorXd b = random_matrix(random, size).col(0);
    Lu lu;
    ASSERT_TRUE(lu.factor(matrix));
    Eigen::VectorXd x = b;
    lu.solve(x);
    Eigen::VectorXd y = b;
    lu.solve_transposed(y);
    const double determinant = Eigen::MatrixXd(matrix).fullPivLu().determinant();
    EXPECT_LT((matrix * x - b).norm(), 1e-11 * (1.0 + x.norm())) << size;
    EXPECT_LT((matrix.transpose() * y - b).norm(), 1e-11 * (1.0 + y.norm())) << size;
    EXPECT_NEAR(lu.determinant(), determinant, 1e-11 * std::abs(determinant)) << size;
  }
}

TEST(SmallLu, RefusesWhatHasNoSolution) {
  Lu lu;
  Lu::Matrix matrix = Lu::Matrix::Zero(3, 3);
  matrix(0, 1) = 2.0;
  matrix(2, 0) = 1.0;
  EXPECT_FALSE(lu.factor(matrix));
  EXPECT_EQ(lu.determinant(), 0.0);
  matrix(1, 2) = std::nan("");
  EXPECT_FALSE(lu.factor(matrix));
}

}  // namespace
}  // namespace softfinger
