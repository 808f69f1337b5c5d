#include "softfinger/numerics/block_cholesky.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>

#include "softfinger/numerics/dense_panel.hpp"
#include "softfinger/threads/spin_until.hpp"

namespace softfinger {
namespace {

/// Columns join while the zeros this stores stay few: wide panels run faster than exact ones.
constexpr int kAlwaysJoin = 4;
constexpr double kZeroFraction = 0.25;
/// Wider ones are split: threads can work on both, and products of panels run faster than the
/// factorisation of one.
constexpr int kWidest = 32;

int padded(int rows) { return (rows + kPanelAlignment - 1) / kPanelAlignment * kPanelAlignment; }

}  // namespace

BlockCholesky::BlockCholesky(int blocks, std::span<const std::pair<int, int>> pairs,
                             InstructionSet set, int threads)
    : set_(set) {
  EliminationOrder order = elimination_order(blocks, pairs);
  find_supernodes(order);
  position_ = std::move(order.position);
  list_updates();
  reserve_scratch(static_cast<std::size_t>(threads));
}

void BlockCholesky::find_supernodes(const EliminationOrder& order) {
  const auto blocks = static_cast<int>(order.position.size());
  supernode_of_.assign(order.position.size(), 0);
  coupling_first_ = order.part_begin.back();
  std::size_t value_count = 0;
  for (std::size_t part = 0; part < order.part_begin.size(); ++part) {
    part_begin_.push_back(static_cast<int>(supernodes_.size()));
    const int part_end = part + 1 < order.part_begin.size() ? order.part_begin[part + 1] : blocks;
    for (int first = order.part_begin[part]; first < part_end;) {
      int last = first;
      std::size_t true_entries = order.below[static_cast<std::size_t>(first)].size() + 1;
      while (last + 1 < std::min(part_end, first + kWidest)) {
        const auto& rows = order.below[static_cast<std::size_t>(last)];
        if (rows.empty() || rows.front() != last + 1) break;
        const std::size_t joined_rows = order.below[static_cast<std::size_t>(last + 1)].size() + 1;
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
      const auto& tail = order.below[static_cast<std::size_t>(last)];
      rows_.insert(rows_.end(), tail.begin(), tail.end());
      node.row_count = static_cast<int>(rows_.size()) - node.row_begin;
      const auto rows = rows_.begin() + node.row_begin;
      node.coupling_from = static_cast<int>(
          std::lower_bound(rows + node.width, rows_.end(), coupling_first_) - rows);
      node.stride = padded(3 * node.row_count);
      node.offset = static_cast<int>(value_count);
      // Vectors may be read past the last row of the last column, while the next panel is written.
      value_count += static_cast<std::size_t>(node.stride * 3 * node.width + kPanelAlignment);
      supernodes_.push_back(node);
      first = last + 1;
    }
  }
  part_begin_.push_back(static_cast<int>(supernodes_.size()));
  values_.assign(value_count, 0.0F);
}

void BlockCholesky::list_updates() {
  std::vector<std::vector<Update>> of_target(supernodes_.size());
  for (std::size_t s = 0; s < supernodes_.size(); ++s) {
    const Supernode& source = supernodes_[s];
    const int* rows = rows_.data() + source.row_begin;
    for (int from = source.width; from < source.row_count;) {
      const auto t = static_cast<std::size_t>(supernode_of_[static_cast<std::size_t>(rows[from])]);
      const int end_column = supernodes_[t].first + supernodes_[t].width;
      int columns = 0;
      while (from + columns < source.row_count && rows[from + columns] < end_column) ++columns;
      of_target[t].push_back({static_cast<int>(s), from, columns});
      from += columns;
    }
  }
  for (std::size_t t = 0; t < supernodes_.size(); ++t) {
    supernodes_[t].update_begin = static_cast<int>(updates_.size());
    updates_.insert(updates_.end(), of_target[t].begin(), of_target[t].end());
    supernodes_[t].update_end = static_cast<int>(updates_.size());
  }
  finished_.assign(supernodes_.size(), 0);
}

void BlockCholesky::reserve_scratch(std::size_t threads) {
  std::size_t update = 0;
  int most_rows = 0;
  for (const Update& one : updates_) {
    const Supernode& source = supernodes_[static_cast<std::size_t>(one.source)];
    const int rows = padded(3 * (source.row_count - one.from));
    update = std::max(update,
                      static_cast<std::size_t>(rows) * static_cast<std::size_t>(3 * one.columns));
  }
  for (const Supernode& node : supernodes_) most_rows = std::max(most_rows, node.row_count);
  const std::size_t blocks = position_.size();
  const auto coupling = blocks - static_cast<std::size_t>(coupling_first_);
  Scratch scratch;
  scratch.update.assign(update + 2 * kPanelAlignment, 0.0F);
  scratch.stretches.assign(static_cast<std::size_t>(most_rows), Stretch{});
  scratch.place.assign(blocks, 0);
  scratch.right_sides.assign(kTogether * 3 * blocks, 0.0F);
  scratch.couplings.assign(kTogether * 3 * coupling * (part_begin_.size() - 2), 0.0F);
  scratch.panel_side.assign(
      kTogether * static_cast<std::size_t>(padded(3 * most_rows)) + 2 * kPanelAlignment, 0.0F);
  scratch_.assign(threads, scratch);
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

void BlockCholesky::subtract(const Update& update, const Supernode& target, Scratch& scratch) {
  const Supernode& source = supernodes_[static_cast<std::size_t>(update.source)];
  const int* rows = rows_.data() + source.row_begin + update.from;
  const int count = source.row_count - update.from;
  const int stride = padded(3 * count);
  dense_panel_kernels(set_).outer_product(values_.data() + source.offset + 3 * update.from,
                                          source.stride, 3 * count, 3 * update.columns,
                                          3 * source.width, scratch.update.data(), stride);
  Stretch* const stretches = scratch.stretches.data();
  int stretch_count = 0;
  for (int i = 0, next = -1; i < count; ++i) {
    const int place = scratch.place[static_cast<std::size_t>(rows[i])];
    if (place != next) stretches[stretch_count++] = {i, place};
    next = place + 1;
  }
  float* const panel = values_.data() + target.offset;
  for (int j = 0, first = 0; j < update.columns; ++j) {
    const float* const u = scratch.update.data() + 3 * j * stride;
    float* const t = panel + 3 * (rows[j] - target.first) * target.stride;
    while (first + 1 < stretch_count && stretches[first + 1].from <= j) ++first;
    for (int k = first; k < stretch_count; ++k) {
      const int from = std::max(stretches[k].from, j);
      const int to = stretches[k].to + from - stretches[k].from;
      const int length = (k + 1 < stretch_count ? stretches[k + 1].from : count) - from;
      for (int c = 0; c < 3; ++c) {
        float* const tc = t + c * target.stride + 3 * to;
        const float* const uc = u + c * stride + 3 * from;
        for (int r = 0; r < 3 * length; ++r) tc[r] -= uc[r];
      }
    }
  }
}

bool BlockCholesky::factor_supernode(std::size_t s, Scratch& scratch) {
  const Supernode& target = supernodes_[s];
  for (int k = 0; k < target.row_count; ++k) {
    const int row = rows_[static_cast<std::size_t>(target.row_begin + k)];
    scratch.place[static_cast<std::size_t>(row)] = k;
  }
  for (int u = target.update_begin; u < target.update_end; ++u) {
    const Update& update = updates_[static_cast<std::size_t>(u)];
    const std::atomic_ref finished(finished_[static_cast<std::size_t>(update.source)]);
    spin_until([&] { return finished.load(std::memory_order_acquire) != 0; });
    subtract(update, target, scratch);
  }
  return dense_panel_kernels(set_).factor(values_.data() + target.offset, 3 * target.row_count,
                                          3 * target.width, target.stride);
}

bool BlockCholesky::factor(ThreadTeam* team) {
  std::fill(finished_.begin(), finished_.end(), 0);
  std::atomic<bool> failed{false};
  const std::size_t parts = part_begin_.size() - 2;
  const auto coupling_begin = static_cast<std::size_t>(part_begin_[parts]);
  // A part is one piece of work, and so is each supernode of the rest. They wait for earlier ones.
  share(parts == 0 ? nullptr : team, parts + supernodes_.size() - coupling_begin,
        [&](std::size_t i, int thread) {
          const bool is_part = i < parts;
          const std::size_t begin =
              is_part ? static_cast<std::size_t>(part_begin_[i]) : coupling_begin + i - parts;
          const std::size_t end =
              is_part ? static_cast<std::size_t>(part_begin_[i + 1]) : begin + 1;
          for (std::size_t s = begin; s < end; ++s) {
            if (!failed && !factor_supernode(s, scratch_[static_cast<std::size_t>(thread)])) {
              failed = true;
            }
            std::atomic_ref(finished_[s]).store(1, std::memory_order_release);
          }
        });
  return !failed;
}

template <std::size_t kCount>
void BlockCholesky::forward(std::size_t part, const Vectors<kCount>& y,
                            const Vectors<kCount>& beyond, int beyond_first, float* t) const {
  const DensePanelKernels& kernels = dense_panel_kernels(set_);
  const auto solve_panel = kCount == 1 ? kernels.solve_forward : kernels.solve_forward_together;
  for (int i = part_begin_[part]; i < part_begin_[part + 1]; ++i) {
    const Supernode& node = supernodes_[static_cast<std::size_t>(i)];
    const int* rows = rows_.data() + node.row_begin;
    const int own = 3 * node.width;
    const auto stride = static_cast<std::size_t>(node.stride);
    for (std::size_t n = 0; n < kCount; ++n) {
      float* tn = t + n * stride;
      std::copy_n(y[n] + 3 * node.first, own, tn);
      std::fill_n(tn + own, 3 * node.row_count - own, 0.0F);
    }
    solve_panel(values_.data() + node.offset, 3 * node.row_count, own, node.stride, t, node.stride);
    for (std::size_t n = 0; n < kCount; ++n) {
      const float* tn = t + n * stride;
      std::copy_n(tn, own, y[n] + 3 * node.first);
      for (int k = node.width; k < node.coupling_from; ++k) {
        for (int c = 0; c < 3; ++c) y[n][3 * rows[k] + c] += tn[3 * k + c];
      }
      for (int k = node.coupling_from; k < node.row_count; ++k) {
        float* to = beyond[n] + 3 * (rows[k] - beyond_first);
        for (int c = 0; c < 3; ++c) to[c] += tn[3 * k + c];
      }
    }
  }
}

template <std::size_t kCount>
void BlockCholesky::backward(std::size_t part, const Vectors<kCount>& y, float* t) const {
  const DensePanelKernels& kernels = dense_panel_kernels(set_);
  const auto solve_panel = kCount == 1 ? kernels.solve_backward : kernels.solve_backward_together;
  for (int i = part_begin_[part + 1] - 1; i >= part_begin_[part]; --i) {
    const Supernode& node = supernodes_[static_cast<std::size_t>(i)];
    const int* rows = rows_.data() + node.row_begin;
    const int own = 3 * node.width;
    const auto stride = static_cast<std::size_t>(node.stride);
    for (std::size_t n = 0; n < kCount; ++n) {
      float* tn = t + n * stride;
      std::copy_n(y[n] + 3 * node.first, own, tn);
      for (int k = node.width; k < node.row_count; ++k) {
        for (int c = 0; c < 3; ++c) tn[3 * k + c] = y[n][3 * rows[k] + c];
      }
    }
    solve_panel(values_.data() + node.offset, 3 * node.row_count, own, node.stride, t, node.stride);
    for (std::size_t n = 0; n < kCount; ++n) {
      std::copy_n(t + n * stride, own, y[n] + 3 * node.first);
    }
  }
}

template <std::size_t kCount>
void BlockCholesky::solve_batch(std::span<const std::span<double>> xs, int thread,
                                ThreadTeam* team) const {
  const std::size_t blocks = position_.size();
  Scratch& own = scratch_[static_cast<std::size_t>(thread)];
  // Brought to the size of one: the smallest right-hand sides would lose digits otherwise.
  std::array<double, kCount> greatest{};
  Vectors<kCount> y{};
  for (std::size_t n = 0; n < kCount; ++n) {
    y[n] = own.right_sides.data() + 3 * blocks * n;
    if (n < xs.size()) {
      for (const double v : xs[n]) greatest[n] = std::max(greatest[n], std::abs(v));
    }
    if (!(greatest[n] > 0.0) || !std::isfinite(greatest[n])) {
      greatest[n] = 0.0;
      std::fill_n(y[n], 3 * blocks, 0.0F);
      continue;
    }
    const double scale = 1.0 / greatest[n];
    for (std::size_t b = 0; b < blocks; ++b) {
      const auto p = static_cast<std::size_t>(position_[b]);
      for (std::size_t c = 0; c < 3; ++c) {
        y[n][3 * p + c] = static_cast<float>(scale * xs[n][3 * b + c]);
      }
    }
  }
  const std::size_t parts = part_begin_.size() - 2;
  const std::size_t coupling = 3 * (blocks - static_cast<std::size_t>(coupling_first_));
  const auto side_of = [&](int worker) {
    return scratch_[static_cast<std::size_t>(team == nullptr ? thread : worker)].panel_side.data();
  };
  const auto coupling_of = [&](std::size_t part, std::size_t n) {
    return own.couplings.data() + (part * kCount + n) * coupling;
  };
  share(team, parts, [&](std::size_t part, int worker) {
    Vectors<kCount> beyond{};
    for (std::size_t n = 0; n < kCount; ++n) {
      beyond[n] = coupling_of(part, n);
      std::fill_n(beyond[n], coupling, 0.0F);
    }
    forward(part, y, beyond, coupling_first_, side_of(worker));
  });
  for (std::size_t part = 0; part < parts; ++part) {
    for (std::size_t n = 0; n < kCount; ++n) {
      float* const to = y[n] + 3 * coupling_first_;
      const float* const from = coupling_of(part, n);
      for (std::size_t k = 0; k < coupling; ++k) to[k] += from[k];
    }
  }
  forward(parts, y, y, 0, side_of(0));
  backward(parts, y, side_of(0));
  share(team, parts, [&](std::size_t part, int worker) { backward(part, y, side_of(worker)); });
  for (std::size_t n = 0; n < xs.size(); ++n) {
    if (greatest[n] == 0.0) continue;
    for (std::size_t b = 0; b < blocks; ++b) {
      const auto p = static_cast<std::size_t>(position_[b]);
      for (std::size_t c = 0; c < 3; ++c) {
        xs[n][3 * b + c] = greatest[n] * static_cast<double>(y[n][3 * p + c]);
      }
    }
  }
}

void BlockCholesky::solve(std::span<double> x, ThreadTeam* team) const {
  solve_batch<1>({&x, 1}, 0, team);
}

void BlockCholesky::solve_together(std::span<const std::span<double>> xs, ThreadTeam* team) const {
  share(team, (xs.size() + kTogether - 1) / kTogether, [&](std::size_t batch, int thread) {
    const std::size_t first = batch * kTogether;
    const std::size_t count = std::min<std::size_t>(kTogether, xs.size() - first);
    if (count == 1) {
      solve_batch<1>(xs.subspan(first, 1), thread, nullptr);
    } else {
      solve_batch<kTogether>(xs.subspan(first, count), thread, nullptr);
    }
  });
}

}  // namespace softfinger
