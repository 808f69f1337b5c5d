#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace softfinger {

/// LU factors of a square matrix of at most kCapacity rows that is mostly zero, with partial
/// pivoting. Columns with few entries come first, and only entries are computed with, so that what
/// is apart stays apart (Davis, "Direct Methods for Sparse Linear Systems", 2006, chapter 6). All
/// storage is inside; nothing allocates.
template <int kCapacity>
class SmallSparseLu {
 public:
  static_assert(kCapacity <= 64, "a row's entries are the bits of one word");
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kCapacity, kCapacity>;

  /// Factors `matrix`; false where it is singular to the last bit or not finite.
  [[nodiscard]] bool factor(const Matrix& matrix) {
    determinant_ = 0.0;
    factors_ = matrix;
    const int n = static_cast<int>(factors_.rows());
    Bits in_row{}, in_column{};
    std::array<int, static_cast<std::size_t>(kCapacity)> count{};
    bool finite = true;
    for (int j = 0; j < n; ++j) {
      std::uint64_t entries = 0;
      for (int i = 0; i < n; ++i) entries |= std::uint64_t{factors_(i, j) != 0.0} << i;
      in_column[at(j)] = entries;
      for_each(entries, [&](int i) {
        finite = finite && std::isfinite(factors_(i, j));
        in_row[at(i)] |= std::uint64_t{1} << j;
        ++count[at(j)];
      });
      int place = j;
      for (; place > 0 && count[at(column_[at(place - 1)])] > count[at(j)]; --place) {
        column_[at(place)] = column_[at(place - 1)];
      }
      column_[at(place)] = j;
    }
    if (!finite) return false;
    std::uint64_t rows_left = ~std::uint64_t{0};
    std::uint64_t columns_left = ~std::uint64_t{0};
    double product = 1.0;
    for (int k = 0; k < n; ++k) {
      const int column = column_[at(k)];
      const int row = pivot(column, in_column[at(column)] & rows_left);
      if (row < 0) return false;
      row_[at(k)] = row;
      rows_left &= ~(std::uint64_t{1} << row);
      columns_left &= ~(std::uint64_t{1} << column);
      below_[at(k)] = in_column[at(column)] & rows_left;
      beside_[at(k)] = in_row[at(row)] & columns_left;
      const double value = factors_(row, column);
      product *= value;
      for_each(below_[at(k)], [&](int i) {
        const double factor = factors_(i, column) /= value;
        for_each(beside_[at(k)], [&](int j) { factors_(i, j) -= factor * factors_(row, j); });
        in_row[at(i)] |= beside_[at(k)];
      });
      for_each(beside_[at(k)], [&](int j) { in_column[at(j)] |= below_[at(k)]; });
    }
    determinant_ = odd(row_, n) == odd(column_, n) ? product : -product;
    return true;
  }

  /// b becomes the solution x of A x = b.
  void solve(Eigen::Ref<Eigen::VectorXd> b) const {
    const Eigen::Index n = factors_.rows();
    std::array<double, static_cast<std::size_t>(kCapacity)> x{};
    for (Eigen::Index k = 0; k < n; ++k) {
      const double value = b[row_[at(k)]];
      if (value == 0.0) continue;
      for_each(below_[at(k)], [&](int i) { b[i] -= factors_(i, column_[at(k)]) * value; });
    }
    for (Eigen::Index k = n - 1; k >= 0; --k) {
      const int row = row_[at(k)];
      const int column = column_[at(k)];
      double value = b[row];
      for_each(beside_[at(k)], [&](int j) { value -= factors_(row, j) * x[at(j)]; });
      x[at(column)] = value / factors_(row, column);
    }
    for (Eigen::Index j = 0; j < n; ++j) b[j] = x[at(j)];
  }

  /// b becomes the solution x of A^T x = b.
  void solve_transposed(Eigen::Ref<Eigen::VectorXd> b) const {
    const Eigen::Index n = factors_.rows();
    std::array<double, static_cast<std::size_t>(kCapacity)> x{};
    for (Eigen::Index k = 0; k < n; ++k) {
      const int row = row_[at(k)];
      const double value = b[column_[at(k)]] / factors_(row, column_[at(k)]);
      x[at(row)] = value;
      for_each(beside_[at(k)], [&](int j) { b[j] -= factors_(row, j) * value; });
    }
    for (Eigen::Index k = n - 1; k >= 0; --k) {
      double& value = x[at(row_[at(k)])];
      for_each(below_[at(k)], [&](int i) { value -= factors_(i, column_[at(k)]) * x[at(i)]; });
    }
    for (Eigen::Index i = 0; i < n; ++i) b[i] = x[at(i)];
  }

  /// 0 where it is singular.
  [[nodiscard]] double determinant() const { return determinant_; }

  /// Entries of both factors, without L's ones.
  [[nodiscard]] int entry_count() const {
    int count = static_cast<int>(factors_.rows());
    for (Eigen::Index k = 0; k < factors_.rows(); ++k) {
      count += std::popcount(below_[at(k)]) + std::popcount(beside_[at(k)]);
    }
    return count;
  }

 private:
  using Bits = std::array<std::uint64_t, static_cast<std::size_t>(kCapacity)>;
  using Order = std::array<int, static_cast<std::size_t>(kCapacity)>;

  template <typename Index>
  static std::size_t at(Index index) {
    return static_cast<std::size_t>(index);
  }

  template <typename Do>
  static void for_each(std::uint64_t bits, Do&& with) {
    for (; bits != 0; bits &= bits - 1) with(std::countr_zero(bits));
  }

  /// Of a column's `rows` that with the largest entry; -1 if all are 0.
  int pivot(int column, std::uint64_t rows) const {
    double largest = 0.0;
    int found = -1;
    for_each(rows, [&](int i) {
      if (std::abs(factors_(i, column)) > largest) {
        largest = std::abs(factors_(i, column));
        found = i;
      }
    });
    return found;
  }

  /// Whether a permutation of 0..n-1 is an odd one: of cycles of length m, each m - 1 swaps.
  static bool odd(const Order& order, int n) {
    std::uint64_t seen = 0;
    bool odd = false;
    for (int first = 0; first < n; ++first) {
      if ((seen >> first & 1) != 0) continue;
      seen |= std::uint64_t{1} << first;
      for (int k = order[at(first)]; k != first; k = order[at(k)]) {
        seen |= std::uint64_t{1} << k;
        odd = !odd;
      }
    }
    return odd;
  }

  Matrix factors_;       ///< L below the pivots, its ones left out, and U, in the matrix's places
  Order row_, column_;   ///< of the pivots, in their order
  Bits below_, beside_;  ///< a pivot's entries of L in its column and of U in its row
  double determinant_ = 0.0;
};

}  // namespace softfinger
