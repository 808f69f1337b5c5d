#include "softfinger/numerics/block_cholesky.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "softfinger/numerics/dense_panel.hpp"

namespace softfinger {
namespace {

using Pairs = std::span<const std::pair<int, int>>;

int padded(int rows) { return (rows + kPanelAlignment - 1) / kPanelAlignment * kPanelAlignment; }

/// Place of each block in a fill-reducing elimination order.
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

/// Block rows below the diagonal of each column of L, sorted, in elimination order.
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

}  // namespace

BlockCholesky::BlockCholesky(int blocks, Pairs pairs, InstructionSet set, int threads) : set_(set) {
  order_and_analyse(blocks, pairs);
  work_.assign(work_size_ * static_cast<std::size_t>(threads), 0.0F);
}

void BlockCholesky::order_and_analyse(int blocks, Pairs pairs) {
  position_ = minimum_degree_positions(blocks, pairs);
  const auto below = factor_structure(position_, pairs);
  supernode_of_.assign(static_cast<std::size_t>(blocks), 0);

  // Columns join while the zeros this stores stay few: wide panels run faster than exact ones.
  constexpr int kAlwaysJoin = 4;
  constexpr double kZeroFraction = 0.25;
  std::size_t value_count = 0;
  int max_rows = 0;
  for (int first = 0; first < blocks;) {
    int last = first;
    std::size_t true_entries = below[static_cast<std::size_t>(first)].size() + 1;
    while (last + 1 < blocks) {
      const auto& rows = below[static_cast<std::size_t>(last)];
      if (rows.empty() || rows.front() != last + 1) break;
      const std::size_t joined_rows = below[static_cast<std::size_t>(last + 1)].size() + 1;
      const auto width = static_cast<std::size_t>(last + 2 - first);
      const std::size_t joined_entries = true_entries + joined_rows;
      const std::size_t stored = width * (width - 1) / 2 + width * joined_rows;
      const double zeros = static_cast<double>(stored - joined_entries);
      if (width > kAlwaysJoin && zeros > kZeroFraction * static_cast<double>(stored)) break;
      true_entries = joined_entries;
      ++last;
    }
    Supernode node;
    node.first = first;
    node.width = last + 1 - first;
    node.row_begin = static_cast<int>(rows_.size());
    for (int j = first; j <= last; ++j) {
      rows_.push_back(j);
      supernode_of_[static_cast<std::size_t>(j)] = static_cast<int>(supernodes_.size());
    }
    const auto& tail = below[static_cast<std::size_t>(last)];
    rows_.insert(rows_.end(), tail.begin(), tail.end());
    node.row_count = static_cast<int>(rows_.size()) - node.row_begin;
    node.stride = padded(3 * node.row_count);
    node.offset = static_cast<int>(value_count);
    value_count += static_cast<std::size_t>(node.stride) * static_cast<std::size_t>(3 * node.width);
    max_rows = std::max(max_rows, node.row_count);
    supernodes_.push_back(node);
    first = last + 1;
  }
  values_.assign(value_count + 2 * kPanelAlignment, 0.0F);
  const auto side = static_cast<std::size_t>(padded(3 * max_rows));
  update_.assign(side * side + 2 * kPanelAlignment, 0.0F);
  work_size_ = kTogether * (static_cast<std::size_t>(3 * blocks) + side) + 2 * kPanelAlignment;
  relative_.assign(static_cast<std::size_t>(blocks), 0);
  head_.assign(supernodes_.size(), -1);
  next_.assign(supernodes_.size(), -1);
  progress_.assign(supernodes_.size(), 0);
}

BlockCholesky::Slot BlockCholesky::slot(int i, int j) const {
  const int a = position_[static_cast<std::size_t>(i)];
  const int b = position_[static_cast<std::size_t>(j)];
  const int column = std::min(a, b);
  const int row = std::max(a, b);
  const Supernode& node =
      supernodes_[static_cast<std::size_t>(supernode_of_[static_cast<std::size_t>(column)])];
  const auto begin = rows_.begin() + node.row_begin;
  const auto found = std::lower_bound(begin, begin + node.row_count, row);
  assert(found != begin + node.row_count && *found == row);
  Slot slot;
  slot.offset =
      node.offset + 3 * (column - node.first) * node.stride + 3 * static_cast<int>(found - begin);
  // Stored is the block (row, column); its transpose is written where i was eliminated first.
  slot.row = a >= b ? 1 : node.stride;
  slot.column = a >= b ? node.stride : 1;
  return slot;
}

void BlockCholesky::clear() { std::fill(values_.begin(), values_.end(), 0.0F); }

void BlockCholesky::subtract_update(const Supernode& source, int from, Supernode& target) {
  const int* rows = rows_.data() + source.row_begin;
  const int end_column = target.first + target.width;
  int columns = 0;
  while (from + columns < source.row_count && rows[from + columns] < end_column) ++columns;
  const int count = source.row_count - from;
  const int out_stride = padded(3 * count);
  dense_panel_kernels(set_).outer_product(values_.data() + source.offset + 3 * from, source.stride,
                                          3 * count, 3 * columns, 3 * source.width, update_.data(),
                                          out_stride);
  float* panel = values_.data() + target.offset;
  for (int j = 0; j < columns; ++j) {
    const int target_column = 3 * (rows[from + j] - target.first);
    for (int i = j; i < count; ++i) {
      const int target_row = 3 * relative_[static_cast<std::size_t>(rows[from + i])];
      const float* u = update_.data() + 3 * j * out_stride + 3 * i;
      float* t = panel + target_column * target.stride + target_row;
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) t[c * target.stride + r] -= u[c * out_stride + r];
      }
    }
  }
}

bool BlockCholesky::factor() {
  const DensePanelKernels& kernels = dense_panel_kernels(set_);
  std::fill(head_.begin(), head_.end(), -1);
  for (std::size_t s = 0; s < supernodes_.size(); ++s) {
    Supernode& target = supernodes_[s];
    for (int k = 0; k < target.row_count; ++k) {
      relative_[static_cast<std::size_t>(rows_[static_cast<std::size_t>(target.row_begin + k)])] =
          k;
    }
    const int end_column = target.first + target.width;
    for (int d = head_[s]; d != -1;) {
      const auto du = static_cast<std::size_t>(d);
      const Supernode& source = supernodes_[du];
      const int next = next_[du];
      subtract_update(source, progress_[du], target);
      const int* rows = rows_.data() + source.row_begin;
      while (progress_[du] < source.row_count && rows[progress_[du]] < end_column) ++progress_[du];
      if (progress_[du] < source.row_count) {
        const auto later =
            static_cast<std::size_t>(supernode_of_[static_cast<std::size_t>(rows[progress_[du]])]);
        next_[du] = head_[later];
        head_[later] = d;
      }
      d = next;
    }
    if (!kernels.factor(values_.data() + target.offset, 3 * target.row_count, 3 * target.width,
                        target.stride)) {
      return false;
    }
    if (target.row_count > target.width) {
      progress_[s] = target.width;
      const auto later = static_cast<std::size_t>(supernode_of_[static_cast<std::size_t>(
          rows_[static_cast<std::size_t>(target.row_begin + target.width)])]);
      next_[s] = head_[later];
      head_[later] = static_cast<int>(s);
    }
  }
  return true;
}

template <std::size_t kCount>
void BlockCholesky::solve_batch(std::span<const std::span<double>> xs, int thread) const {
  const DensePanelKernels& kernels = dense_panel_kernels(set_);
  const auto forward = kCount == 1 ? kernels.solve_forward : kernels.solve_forward_together;
  const auto backward = kCount == 1 ? kernels.solve_backward : kernels.solve_backward_together;
  const std::size_t blocks = position_.size();
  float* const work = work_.data() + work_size_ * static_cast<std::size_t>(thread);
  // Brought to the size of one: the smallest right-hand sides would lose digits otherwise.
  std::array<double, kCount> greatest{};
  std::array<float*, kCount> y{};
  for (std::size_t s = 0; s < kCount; ++s) {
    y[s] = work + 3 * blocks * s;
    if (s < xs.size()) {
      for (const double v : xs[s]) greatest[s] = std::max(greatest[s], std::abs(v));
    }
    if (!(greatest[s] > 0.0) || !std::isfinite(greatest[s])) {
      greatest[s] = 0.0;
      std::fill_n(y[s], 3 * blocks, 0.0F);
      continue;
    }
    const double scale = 1.0 / greatest[s];
    for (std::size_t b = 0; b < blocks; ++b) {
      const auto p = static_cast<std::size_t>(position_[b]);
      for (std::size_t c = 0; c < 3; ++c) {
        y[s][3 * p + c] = static_cast<float>(scale * xs[s][3 * b + c]);
      }
    }
  }
  float* const t = work + 3 * blocks * kCount;
  for (const Supernode& node : supernodes_) {
    const int* rows = rows_.data() + node.row_begin;
    const int own = 3 * node.width;
    const auto stride = static_cast<std::size_t>(node.stride);
    for (std::size_t s = 0; s < kCount; ++s) {
      float* ts = t + s * stride;
      std::copy_n(y[s] + 3 * node.first, own, ts);
      std::fill_n(ts + own, 3 * node.row_count - own, 0.0F);
    }
    forward(values_.data() + node.offset, 3 * node.row_count, own, node.stride, t, node.stride);
    for (std::size_t s = 0; s < kCount; ++s) {
      const float* ts = t + s * stride;
      float* ys = y[s];
      std::copy_n(ts, own, ys + 3 * node.first);
      for (int k = node.width; k < node.row_count; ++k) {
        for (int c = 0; c < 3; ++c) ys[3 * rows[k] + c] += ts[3 * k + c];
      }
    }
  }
  for (auto node = supernodes_.rbegin(); node != supernodes_.rend(); ++node) {
    const int* rows = rows_.data() + node->row_begin;
    const int own = 3 * node->width;
    const auto stride = static_cast<std::size_t>(node->stride);
    for (std::size_t s = 0; s < kCount; ++s) {
      float* ts = t + s * stride;
      const float* ys = y[s];
      std::copy_n(ys + 3 * node->first, own, ts);
      for (int k = node->width; k < node->row_count; ++k) {
        for (int c = 0; c < 3; ++c) ts[3 * k + c] = ys[3 * rows[k] + c];
      }
    }
    backward(values_.data() + node->offset, 3 * node->row_count, own, node->stride, t,
             node->stride);
    for (std::size_t s = 0; s < kCount; ++s) {
      std::copy_n(t + s * stride, own, y[s] + 3 * node->first);
    }
  }
  for (std::size_t s = 0; s < xs.size(); ++s) {
    if (greatest[s] == 0.0) continue;
    for (std::size_t b = 0; b < blocks; ++b) {
      const auto p = static_cast<std::size_t>(position_[b]);
      for (std::size_t c = 0; c < 3; ++c) {
        xs[s][3 * b + c] = greatest[s] * static_cast<double>(y[s][3 * p + c]);
      }
    }
  }
}

void BlockCholesky::solve(std::span<double> x) const { solve_batch<1>({&x, 1}, 0); }

void BlockCholesky::solve_together(std::span<const std::span<double>> xs, ThreadTeam* team) const {
  const auto batch = [&](std::size_t b, int thread) {
    const std::size_t first = b * kTogether;
    const std::size_t count = std::min<std::size_t>(kTogether, xs.size() - first);
    if (count == 1) {
      solve_batch<1>(xs.subspan(first, 1), thread);
    } else {
      solve_batch<kTogether>(xs.subspan(first, count), thread);
    }
  };
  const std::size_t batches = (xs.size() + kTogether - 1) / kTogether;
  if (team != nullptr) {
    team->run(batches, batch);
  } else {
    for (std::size_t b = 0; b < batches; ++b) batch(b, 0);
  }
}

}  // namespace softfinger
