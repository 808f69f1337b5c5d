#include "softfinger/numerics/elimination_order.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <numeric>

namespace softfinger {
namespace {

using Pairs = std::span<const std::pair<int, int>>;

constexpr std::size_t kParts = 4;
/// Of the whole work: a heavier subtree is cut further.
constexpr double kHeaviestSubtree = 0.25;
/// Multiplications of blocks in a factorisation; with fewer there are no parts.
constexpr double kWorthParting = 1e5;

std::vector<int> minimum_degree_positions(int blocks, Pairs pairs) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * pairs.size() + static_cast<std::size_t>(blocks));
  for (int i = 0; i < blocks; ++i) entries.emplace_back(i, i, 1.0);
  for (const auto& [i, j] : pairs) {
    entries.emplace_back(i, j, 1.0);
    entries.emplace_back(j, i, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(blocks, blocks);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  std::vector<int> position(static_cast<std::size_t>(blocks));
  for (int k = 0; k < blocks; ++k) position[static_cast<std::size_t>(order.indices()[k])] = k;
  return position;
}

std::vector<std::vector<int>> factor_structure(const std::vector<int>& position, Pairs pairs) {
  std::vector<std::vector<int>> below(position.size());
  for (const auto& [i, j] : pairs) {
    const int a = position[static_cast<std::size_t>(i)];
    const int b = position[static_cast<std::size_t>(j)];
    if (a != b) below[static_cast<std::size_t>(std::min(a, b))].push_back(std::max(a, b));
  }
  for (std::size_t j = 0; j < below.size(); ++j) {
    std::vector<int>& rows = below[j];
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    if (rows.empty()) continue;
    // The column fills in its parent in the elimination tree.
    std::vector<int>& parent = below[static_cast<std::size_t>(rows.front())];
    parent.insert(parent.end(), rows.begin() + 1, rows.end());
  }
  return below;
}

/// Part of each column; kParts: above all parts. Every subtree is in one part.
std::vector<std::size_t> part_of_columns(const std::vector<std::vector<int>>& below) {
  const std::size_t columns = below.size();
  std::vector<double> work(columns, 0.0);  // of the subtree
  double whole = 0.0;
  for (std::size_t j = 0; j < columns; ++j) {
    const auto rows = static_cast<double>(below[j].size() + 1);
    work[j] += rows * rows;
    whole += rows * rows;
    if (!below[j].empty()) work[static_cast<std::size_t>(below[j].front())] += work[j];
  }
  std::vector<std::size_t> part(columns, kParts);
  if (whole < kWorthParting) return part;

  std::vector<std::size_t> subtrees;  // by their highest columns
  for (std::size_t j = 0; j < columns; ++j) {
    const bool parent_is_heavy =
        below[j].empty() ||
        work[static_cast<std::size_t>(below[j].front())] > kHeaviestSubtree * whole;
    if (work[j] <= kHeaviestSubtree * whole && parent_is_heavy) subtrees.push_back(j);
  }
  // The heaviest first, each to the part with the least.
  std::stable_sort(subtrees.begin(), subtrees.end(),
                   [&](std::size_t a, std::size_t b) { return work[a] > work[b]; });
  std::vector<double> load(kParts, 0.0);
  for (const std::size_t root : subtrees) {
    const auto least = std::min_element(load.begin(), load.end());
    *least += work[root];
    part[root] = static_cast<std::size_t>(least - load.begin());
  }
  // What lies below is in the same part; parents come after their children.
  for (std::size_t j = columns; j-- > 0;) {
    if (part[j] < kParts || below[j].empty()) continue;
    part[j] = part[static_cast<std::size_t>(below[j].front())];
  }
  return part;
}

}  // namespace

EliminationOrder elimination_order(int blocks, Pairs pairs) {
  EliminationOrder order;
  order.position = minimum_degree_positions(blocks, pairs);
  const std::vector<std::size_t> part = part_of_columns(factor_structure(order.position, pairs));
  std::vector<std::size_t> columns(part.size());
  std::iota(columns.begin(), columns.end(), std::size_t{0});
  std::stable_sort(columns.begin(), columns.end(),
                   [&](std::size_t a, std::size_t b) { return part[a] < part[b]; });
  std::vector<int> place(part.size());
  for (std::size_t k = 0; k < columns.size(); ++k) place[columns[k]] = static_cast<int>(k);
  for (int& p : order.position) p = place[static_cast<std::size_t>(p)];
  order.below = factor_structure(order.position, pairs);
  order.part_begin.push_back(0);
  if (std::ranges::count(part, kParts) == blocks) return order;
  for (std::size_t p = 0; p < kParts; ++p) {
    order.part_begin.push_back(order.part_begin.back() +
                               static_cast<int>(std::ranges::count(part, p)));
  }
  return order;
}

}  // namespace softfinger
