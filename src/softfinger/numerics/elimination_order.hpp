#pragma once

#include <span>
#include <utility>
#include <vector>

namespace softfinger {

/// In which order the unknowns of a sparse symmetric matrix are eliminated, and what of its factor
/// is not zero. Unknowns are blocks; "row" and "column" are places in the order.
struct EliminationOrder {
  std::vector<int> position;  ///< block -> place
  /// Of each column of the factor, the rows below the diagonal, ascending.
  std::vector<std::vector<int>> below;
  /// Parts that do not touch each other come first: part p takes the places from part_begin[p] to
  /// part_begin[p + 1]. Those from part_begin.back() on couple them; all, where there is little to
  /// do.
  std::vector<int> part_begin;
};

/// Approximate minimum degree, its elimination tree cut into subtrees of similar work. `pairs`
/// lists the blocks (i, j) that may be non-zero, either triangle, repetitions allowed.
[[nodiscard]] EliminationOrder elimination_order(int blocks,
                                                 std::span<const std::pair<int, int>> pairs);

}  // namespace softfinger
