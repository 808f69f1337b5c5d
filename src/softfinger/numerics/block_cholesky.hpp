#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "softfinger/base/instruction_set.hpp"
#include "softfinger/numerics/elimination_order.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger {

/// Sparse Cholesky factorisation A = L L^T of a symmetric matrix of 3 x 3 blocks whose pattern is
/// fixed. The constructor orders the blocks (elimination_order.hpp), finds the supernodes and
/// reserves all memory; assembling, factoring and solving allocate nothing.
///
/// A is assembled straight into the memory of L: clear(), add(), factor(), then solve() any number
/// of times. Left-looking and supernodal (Ng and Peyton 1993; Chen et al. 2008, CHOLMOD): what a
/// supernode gets from others is subtracted in a fixed order, and the parts of the elimination
/// order add to what couples them one after the other, so that the bits do not depend on how many
/// threads share the work.
///
/// The factor is in single precision: half the memory and twice the lanes. A solution is good to
/// about 1e-6 relative to a well-scaled system; whoever needs more iterates on the residual in
/// double precision, as Newton's method with its double gradient does by itself.
class BlockCholesky {
 public:
  /// Where a block of A lies. Entry (r, c) is at values[offset + r * row + c * column].
  struct Slot {
    int offset = 0;
    int row = 0;
    int column = 0;
  };

  BlockCholesky() = default;
  /// `blocks` block rows; `pairs` lists the blocks (i, j), i != j, that may be non-zero, either
  /// triangle, repetitions allowed. Diagonal blocks are always there.
  /// `threads`: of the largest team that will factor or solve.
  BlockCholesky(int blocks, std::span<const std::pair<int, int>> pairs, InstructionSet set,
                int threads = 1);

  [[nodiscard]] int blocks() const { return static_cast<int>(position_.size()); }
  /// Slot of block (i, j). The pair must be in the pattern. Only one triangle is stored: assemble
  /// each unordered pair once. Diagonal blocks are assembled whole.
  [[nodiscard]] Slot slot(int i, int j) const;

  void clear();
  /// Memory the slots point into.
  [[nodiscard]] float* values() { return values_.data(); }
  /// Adds a 3 x 3 block, column-major.
  void add(const Slot& slot, const double* block) {
    float* v = values_.data() + slot.offset;
    for (int c = 0; c < 3; ++c) {
      for (int r = 0; r < 3; ++r) {
        v[r * slot.row + c * slot.column] += static_cast<float>(block[3 * c + r]);
      }
    }
  }
  /// Factors what was assembled. Returns false if the matrix is not positive definite; then nothing
  /// can be solved until the next clear().
  [[nodiscard]] bool factor(ThreadTeam* team = nullptr);
  /// Solves A x = b in place; x has 3 * blocks() entries, block i at 3 i.
  void solve(std::span<double> x, ThreadTeam* team = nullptr) const;
  /// Several of them, each with the same bits as alone, in less time.
  void solve_together(std::span<const std::span<double>> xs, ThreadTeam* team = nullptr) const;
  /// Number of stored entries of L.
  [[nodiscard]] std::size_t entries() const { return values_.size(); }

 private:
  struct Supernode {
    int first = 0;      ///< first block column, in elimination order
    int width = 0;      ///< block columns
    int row_begin = 0;  ///< into rows_: block rows, the supernode's own columns first
    int row_count = 0;
    int coupling_from = 0;  ///< of its rows, the first beyond its part; none of a part: its width
    int offset = 0;         ///< into values_
    int stride = 0;         ///< leading dimension of its panel
    int update_begin = 0;   ///< into updates_
    int update_end = 0;
  };
  /// What the factorisation of one supernode, the source, changes in another one.
  struct Update {
    int source = 0;
    int from = 0;     ///< of its rows, the first that is a column of the target
    int columns = 0;  ///< how many are
  };
  /// Rows that follow one another in the source and in the target of an update.
  struct Stretch {
    int from = 0;  ///< in the source
    int to = 0;    ///< in the target
  };
  /// Memory to work in, of one thread.
  struct Scratch {
    std::vector<float> update;
    std::vector<Stretch> stretches;
    std::vector<int> place;  ///< in the target's panel, per block row
    std::vector<float> right_sides, couplings, panel_side;
  };
  template <std::size_t kCount>
  using Vectors = std::array<float*, kCount>;

  void find_supernodes(const EliminationOrder& order);
  void list_updates();
  void reserve_scratch(std::size_t threads);
  bool factor_supernode(std::size_t s, Scratch& scratch);
  void subtract(const Update& update, const Supernode& target, Scratch& scratch);
  template <std::size_t kCount>
  void solve_batch(std::span<const std::span<double>> xs, int thread, ThreadTeam* team) const;
  template <std::size_t kCount>
  void forward(std::size_t part, const Vectors<kCount>& y, const Vectors<kCount>& beyond,
               int beyond_first, float* t) const;
  template <std::size_t kCount>
  void backward(std::size_t part, const Vectors<kCount>& y, float* t) const;

  InstructionSet set_ = InstructionSet::kBaseline;
  std::vector<int> position_;  ///< block -> place in elimination order
  std::vector<int> supernode_of_;
  std::vector<Supernode> supernodes_;
  std::vector<int> rows_;
  std::vector<Update> updates_;  ///< of each target, sources in elimination order
  /// Supernodes of part p are [part_begin_[p], part_begin_[p + 1]); the last "part" couples the
  /// others and begins with block column coupling_first_.
  std::vector<int> part_begin_;
  int coupling_first_ = 0;
  std::vector<float> values_;
  std::vector<std::uint32_t> finished_;  ///< per supernode, in factor()
  mutable std::vector<Scratch> scratch_;
};

}  // namespace softfinger
