#include "softfinger/numerics/block_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace softfinger {
namespace {

struct RandomSystem {
  std::vector<std::pair<int, int>> pairs;
  Eigen::MatrixXd matrix;
};

/// A grid-like pattern with some long links, diagonally dominant or with one negative eigenvalue.
RandomSystem random_system(int blocks, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::uniform_int_distribution<int> any(0, blocks - 1);
  RandomSystem system;
  for (int i = 0; i < blocks; ++i) {
    for (int step : {1, 2, 7}) {
      if (i + step < blocks) system.pairs.emplace_back(i, i + step);
    }
  }
  for (int k = 0; k < blocks / 4; ++k) {
    const int i = any(generator);
    const int j = any(generator);
    if (i != j) system.pairs.emplace_back(i, j);
  }
  std::sort(system.pairs.begin(), system.pairs.end());
  system.matrix = Eigen::MatrixXd::Zero(3 * blocks, 3 * blocks);
  for (const auto& [i, j] : system.pairs) {
    Eigen::Matrix3d block;
    for (double& entry : block.reshaped()) entry = value(generator);
    system.matrix.block<3, 3>(3 * i, 3 * j) = block;
    system.matrix.block<3, 3>(3 * j, 3 * i) = block.transpose();
  }
  for (int r = 0; r < 3 * blocks; ++r) {
    system.matrix(r, r) = 1.0 + system.matrix.row(r).cwiseAbs().sum();
  }
  return system;
}

void assemble(const RandomSystem& system, BlockCholesky& cholesky) {
  cholesky.clear();
  const auto add = [&](int i, int j) {
    const Eigen::Matrix3d block = system.matrix.block<3, 3>(3 * i, 3 * j);
    cholesky.add(cholesky.slot(i, j), block.data());
  };
  for (int i = 0; i < cholesky.blocks(); ++i) add(i, i);
  for (std::size_t k = 0; k < system.pairs.size(); ++k) {
    const auto [i, j] = system.pairs[k];
    const bool again = std::any_of(
        system.pairs.begin(), system.pairs.begin() + static_cast<long>(k),
        [i = i, j = j](const auto& p) { return p == std::pair(i, j) || p == std::pair(j, i); });
    if (!again) add(i, j);
  }
}

class EveryInstructionSet : public testing::TestWithParam<InstructionSet> {
 protected:
  void SetUp() override {
    if (GetParam() > best_instruction_set()) GTEST_SKIP() << "this processor lacks it";
  }
};

TEST_P(EveryInstructionSet, SolvesAsADenseFactorisationDoes) {
  for (int blocks : {1, 2, 5, 30, 130}) {
    const RandomSystem system = random_system(blocks, static_cast<unsigned>(blocks));
    BlockCholesky cholesky(blocks, system.pairs, GetParam());
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(3 * blocks, -1.0, 2.0);
    for (int repetition = 0; repetition < 2; ++repetition) {
      assemble(system, cholesky);
      ASSERT_TRUE(cholesky.factor());
      // Single precision at once, double after a few corrections; whatever the size of the numbers.
      for (const double size : {1e-12, 1.0, 1e9}) {
        Eigen::VectorXd x = Eigen::VectorXd::Zero(right.size());
        for (const double bound : {1e-5, 1e-10, 1e-14}) {
          Eigen::VectorXd correction = size * right - system.matrix * x;
          cholesky.solve({correction.data(), static_cast<std::size_t>(correction.size())});
          x += correction;
          EXPECT_LT((system.matrix * x - size * right).norm(), bound * size * right.norm());
        }
      }
    }
  }
}

TEST_P(EveryInstructionSet, SeveralRightSidesGetTheSameBitsAsAlone) {
  for (int blocks : {1, 7, 130}) {
    const RandomSystem system = random_system(blocks, 5);
    BlockCholesky cholesky(blocks, system.pairs, GetParam());
    assemble(system, cholesky);
    ASSERT_TRUE(cholesky.factor());
    for (std::size_t count : {0U, 1U, 2U, 3U, 4U, 8U}) {
      std::vector<std::vector<double>> alone;
      for (std::size_t n = 0; n < count; ++n) {
        const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(
            3 * blocks, -1.0, n == 2 ? -1.0 : 1e3 * static_cast<double>(n) - 2e3);
        alone.emplace_back(x.begin(), x.end());
      }
      if (count > 3) std::fill(alone[3].begin(), alone[3].end(), 0.0);
      std::vector<std::vector<double>> together = alone;
      std::vector<std::span<double>> spans(together.begin(), together.end());
      cholesky.solve_together(spans);
      for (std::vector<double>& x : alone) cholesky.solve(x);
      EXPECT_EQ(together, alone) << blocks << " blocks, " << count;
    }
  }
}

TEST_P(EveryInstructionSet, AnyNumberOfThreadsGivesTheSameBits) {
  const int blocks = 600;
  const RandomSystem system = random_system(blocks, 9);
  ASSERT_GT(elimination_order(blocks, system.pairs).part_begin.size(), 1U) << "nothing to share";
  const auto solution = [&](ThreadTeam* team) {
    BlockCholesky cholesky(blocks, system.pairs, GetParam(), team == nullptr ? 1 : team->threads());
    std::vector<std::vector<double>> xs(5, std::vector<double>(3 * blocks, 1.0));
    for (int repetition = 0; repetition < 3; ++repetition) {
      assemble(system, cholesky);
      EXPECT_TRUE(cholesky.factor(team));
      for (std::size_t n = 0; n < xs.size(); ++n) xs[n][7 * n] += 1.0;
      cholesky.solve(xs[0], team);
      std::vector<std::span<double>> spans(xs.begin() + 1, xs.end());
      cholesky.solve_together(spans, team);
    }
    return xs;
  };
  const auto alone = solution(nullptr);
  for (const int threads : {1, 2, 3, 5}) {
    ThreadTeam team(threads);
    EXPECT_EQ(solution(&team), alone) << threads;
  }
}

TEST_P(EveryInstructionSet, RefusesAnIndefiniteMatrix) {
  RandomSystem system = random_system(40, 3);
  BlockCholesky cholesky(40, system.pairs, GetParam());
  for (int entry : {0, 60, 119}) {
    RandomSystem indefinite = system;
    indefinite.matrix(entry, entry) = -1.0;
    assemble(indefinite, cholesky);
    EXPECT_FALSE(cholesky.factor()) << entry;
  }
  assemble(system, cholesky);
  EXPECT_TRUE(cholesky.factor());
}

INSTANTIATE_TEST_SUITE_P(BlockCholesky, EveryInstructionSet,
                         testing::Values(InstructionSet::kBaseline, InstructionSet::kAvx2,
                                         InstructionSet::kAvx512),
                         [](const auto& set) { return std::string(name_of(set.param)); });

}  // namespace
}  // namespace softfinger
