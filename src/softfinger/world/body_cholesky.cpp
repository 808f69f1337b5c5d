#include "softfinger/world/body_cholesky.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

constexpr std::size_t kEliminated = static_cast<std::size_t>(-1);

/// L of a block in place, its upper triangle left as it is.
bool factor_block(Matrix6& A) {
  for (int k = 0; k < 6; ++k) {
    const double pivot = A(k, k);
    if (!(pivot > 0.0)) return false;
    const double root = std::sqrt(pivot);
    A(k, k) = root;
    for (int i = k + 1; i < 6; ++i) A(i, k) /= root;
    for (int j = k + 1; j < 6; ++j) {
      for (int i = j; i < 6; ++i) A(i, j) -= A(i, k) * A(j, k);
    }
  }
  return true;
}

}  // namespace

void BodyCholesky::reserve(std::size_t blocks) {
  linked_.reserve(blocks * blocks);
  slots_.reserve(blocks * blocks);
  below_.reserve(blocks * (blocks + 1) / 2);
  values_.reserve(blocks * (blocks + 1) / 2);
  starts_.reserve(blocks + 1);
  for (auto* const numbers : {&degrees_, &order_, &position_}) numbers->reserve(blocks);
  freedoms_.reserve(blocks);
  sides_.reserve(blocks);
}

void BodyCholesky::begin(std::size_t blocks) {
  blocks_ = blocks;
  linked_.assign(blocks * blocks, 0);
  degrees_.assign(blocks, 0);
}

void BodyCholesky::couple(std::size_t a, std::size_t b) {
  if (a == b || linked_[a * blocks_ + b] != 0) return;
  linked_[a * blocks_ + b] = linked_[b * blocks_ + a] = 1;
  ++degrees_[a];
  ++degrees_[b];
}

void BodyCholesky::arrange() {
  const std::size_t n = blocks_;
  order_.clear();
  position_.assign(n, 0);
  starts_.assign(1, 0);
  below_.clear();
  while (order_.size() < n) {
    const auto least = std::ranges::min_element(degrees_);
    const auto k = static_cast<std::size_t>(least - degrees_.begin());
    position_[k] = order_.size();
    order_.push_back(k);
    degrees_[k] = kEliminated;
    const std::size_t first = below_.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (linked_[k * n + i] != 0 && degrees_[i] != kEliminated) below_.push_back(i);
    }
    starts_.push_back(below_.size());
    // What it was linked to hangs together from now on.
    for (std::size_t p = first; p < below_.size(); ++p) {
      --degrees_[below_[p]];
      for (std::size_t q = first; q < p; ++q) couple(below_[p], below_[q]);
    }
  }
  slots_.assign(n * n, -1);
  for (std::size_t k = 0; k < n; ++k) {
    slots_[k * n + k] = static_cast<int>(k);
    for (std::size_t p = starts_[k]; p < starts_[k + 1]; ++p) {
      below_[p] = position_[below_[p]];
      slots_[below_[p] * n + k] = static_cast<int>(n + p);
    }
    std::sort(below_.begin() + static_cast<std::ptrdiff_t>(starts_[k]),
              below_.begin() + static_cast<std::ptrdiff_t>(starts_[k + 1]));
  }
  filled_ = n + below_.size();
  values_.resize(filled_);
  sides_.resize(n);
}

void BodyCholesky::clear(std::span<const int> freedoms) {
  freedoms_.assign(freedoms.begin(), freedoms.end());
  for (Matrix6& block : values_) block.setZero();
  for (std::size_t k = 0; k < blocks_; ++k) {
    for (int r = freedoms_[order_[k]]; r < 6; ++r) values_[k](r, r) = 1.0;
  }
}

bool BodyCholesky::factor() {
  for (std::size_t k = 0; k < blocks_; ++k) {
    Matrix6& own = values_[k];
    if (!factor_block(own)) return false;
    const std::span<const std::size_t> rows = below(k);
    for (const std::size_t i : rows) {
      // X L^T = A
      Matrix6& X = values_[slot(i, k)];
      for (int c = 0; c < 6; ++c) {
        for (int j = 0; j < c; ++j) X.col(c) -= own(c, j) * X.col(j);
        X.col(c) /= own(c, c);
      }
    }
    for (std::size_t p = 0; p < rows.size(); ++p) {
      const Matrix6& left = values_[slot(rows[p], k)];
      for (std::size_t q = 0; q <= p; ++q) {
        const Matrix6& right = values_[slot(rows[q], k)];
        values_[slot(rows[p], rows[q])].noalias() -= left.lazyProduct(right.transpose());
      }
    }
  }
  return true;
}

void BodyCholesky::solve(std::span<double> x) {
  for (std::size_t k = 0; k < blocks_; ++k) {
    sides_[k].setZero();
    for (int r = 0; r < freedoms_[order_[k]]; ++r) {
      sides_[k][r] = x[6 * order_[k] + static_cast<std::size_t>(r)];
    }
  }
  for (std::size_t k = 0; k < blocks_; ++k) {
    values_[k].triangularView<Eigen::Lower>().solveInPlace(sides_[k]);
    for (const std::size_t i : below(k)) {
      sides_[i].noalias() -= values_[slot(i, k)].lazyProduct(sides_[k]);
    }
  }
  for (std::size_t k = blocks_; k-- > 0;) {
    for (const std::size_t i : below(k)) {
      sides_[k].noalias() -= values_[slot(i, k)].transpose().lazyProduct(sides_[i]);
    }
    values_[k].triangularView<Eigen::Lower>().transpose().solveInPlace(sides_[k]);
  }
  for (std::size_t k = 0; k < blocks_; ++k) {
    for (int r = 0; r < freedoms_[order_[k]]; ++r) {
      x[6 * order_[k] + static_cast<std::size_t>(r)] = sides_[k][r];
    }
  }
}

}  // namespace softfinger
