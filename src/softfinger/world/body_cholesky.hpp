#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "softfinger/finger/obstacle_coupling.hpp"

namespace softfinger {

/// Cholesky's factorisation A = L L^T of a symmetric matrix of 6 x 6 blocks, a row and a column of
/// blocks a body, most of which are empty: who touches nobody has no block with anybody. Blocks are
/// eliminated in the order of least degree (ties by number), found together with what fills up
/// whenever the pattern changes. Bodies of fewer than six coordinates leave the last rows of their
/// block to themselves. Allocates nothing after reserve().
///
///     cholesky.begin(bodies); cholesky.couple(a, b) ...; cholesky.arrange();
///     cholesky.clear(freedoms); cholesky.add(...) ...; if (cholesky.factor()) cholesky.solve(x);
class BodyCholesky {
 public:
  /// Memory for so many blocks.
  void reserve(std::size_t blocks);
  /// So many blocks, none of which is coupled to another.
  void begin(std::size_t blocks);
  void couple(std::size_t a, std::size_t b);
  /// The pattern is known.
  void arrange();

  /// All entries zero; `freedoms`: rows of each block that are in use, 1 to 6.
  void clear(std::span<const int> freedoms);
  /// Adds to entry (row, column) of block (a, b), which is coupled. Of each two blocks that mirror
  /// each other one is to be added to, of (a, a) all of it.
  void add(std::size_t a, int row, std::size_t b, int column, double value) {
    const std::size_t i = position_[a];
    const std::size_t j = position_[b];
    if (i >= j) {
      values_[slot(i, j)](row, column) += value;
    } else {
      values_[slot(j, i)](column, row) += value;
    }
  }
  /// False if the matrix is not positive definite.
  [[nodiscard]] bool factor();
  /// x = A^-1 x, six entries a block; of those not in use nothing is read or written.
  void solve(std::span<double> x);
  /// Blocks of L: what factor() costs.
  [[nodiscard]] std::size_t filled() const { return filled_; }

 private:
  [[nodiscard]] std::size_t slot(std::size_t i, std::size_t j) const {
    return static_cast<std::size_t>(slots_[i * blocks_ + j]);
  }
  [[nodiscard]] std::span<const std::size_t> below(std::size_t k) const {
    return {below_.data() + starts_[k], starts_[k + 1] - starts_[k]};
  }

  std::size_t blocks_ = 0, filled_ = 0;
  std::vector<std::uint8_t> linked_;   ///< by two blocks, as they are eliminated
  std::vector<std::size_t> degrees_;   ///< by block
  std::vector<std::size_t> order_;     ///< blocks by position
  std::vector<std::size_t> position_;  ///< by block
  std::vector<std::size_t> starts_;    ///< by position, into below_
  std::vector<std::size_t> below_;  ///< positions of the blocks below the diagonal that are filled
  std::vector<int> slots_;          ///< by two positions, into values_; of those that are filled
  std::vector<Matrix6> values_;
  std::vector<int> freedoms_;   ///< by block
  std::vector<Vector6> sides_;  ///< by position
};

}  // namespace softfinger
