#include "softfinger/numerics/elimination_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace softfinger {
namespace {

/// Neighbours in a box of side^3 blocks, diagonals too.
std::vector<std::pair<int, int>> pairs_of_box(int side) {
  std::vector<std::pair<int, int>> pairs;
  const auto at = [side](int x, int y, int z) { return (z * side + y) * side + x; };
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        for (int k = 1; k < 8; ++k) {
          const int dx = k & 1, dy = k >> 1 & 1, dz = k >> 2;
          if (x + dx < side && y + dy < side && z + dz < side) {
            pairs.emplace_back(at(x + dx, y + dy, z + dz), at(x, y, z));
          }
        }
      }
    }
  }
  return pairs;
}

TEST(EliminationOrder, KnowsWhatFillsIn) {
  const int side = 6;
  const auto pairs = pairs_of_box(side);
  const EliminationOrder order = elimination_order(side * side * side, pairs);
  std::vector<std::set<int>> graph(order.position.size());
  for (const auto& [i, j] : pairs) {
    const int a = order.position[static_cast<std::size_t>(i)];
    const int b = order.position[static_cast<std::size_t>(j)];
    graph[static_cast<std::size_t>(a)].insert(b);
    graph[static_cast<std::size_t>(b)].insert(a);
  }
  // Elimination as it is told: who goes ties together all that are left of its neighbours.
  for (std::size_t k = 0; k < graph.size(); ++k) {
    const std::vector<int> left(graph[k].upper_bound(static_cast<int>(k)), graph[k].end());
    ASSERT_EQ(order.below[k], left) << k;
    for (const int a : left) {
      for (const int b : left) {
        if (a != b) graph[static_cast<std::size_t>(a)].insert(b);
      }
    }
  }
}

TEST(EliminationOrder, PartsDoNotTouchEachOther) {
  const int side = 14;
  const auto pairs = pairs_of_box(side);
  const EliminationOrder order = elimination_order(side * side * side, pairs);
  std::vector<int> places = order.position;
  std::sort(places.begin(), places.end());
  for (std::size_t k = 0; k < places.size(); ++k) ASSERT_EQ(places[k], k);
  ASSERT_GT(order.part_begin.size(), 2U) << "there is enough to do";
  const auto part_of = [&](std::size_t place) {
    return std::upper_bound(order.part_begin.begin(), order.part_begin.end(),
                            static_cast<int>(place)) -
           order.part_begin.begin();
  };
  const auto coupling = static_cast<std::ptrdiff_t>(order.part_begin.size());
  for (std::size_t k = 0; k < order.below.size(); ++k) {
    for (const int row : order.below[k]) {
      const auto part = part_of(static_cast<std::size_t>(row));
      EXPECT_TRUE(part == part_of(k) || part == coupling) << k << ", " << row;
    }
  }
  EXPECT_LT(order.part_begin.back(), side * side * side);
  for (std::size_t p = 1; p < order.part_begin.size(); ++p) {
    EXPECT_GT(order.part_begin[p], order.part_begin[p - 1]) << "a part without work";
  }
}

TEST(EliminationOrder, OfWhatIsSmallHasNoParts) {
  EXPECT_EQ(elimination_order(27, pairs_of_box(3)).part_begin, std::vector<int>{0});
  EXPECT_EQ(elimination_order(1, {}).below, std::vector<std::vector<int>>{{}});
}

}  // namespace
}  // namespace softfinger
