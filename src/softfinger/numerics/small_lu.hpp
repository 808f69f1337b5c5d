#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <utility>

namespace softfinger {

/// LU factors with partial pivoting of a square matrix of at most kCapacity rows (Golub and Van
/// Loan, "Matrix Computations", algorithm 3.4.1). All storage is inside; nothing allocates.
template <int kCapacity>
class SmallLu {
 public:
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kCapacity, kCapacity>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kCapacity, 1>;

  /// Factors `matrix`; false where it is singular to the last bit or not finite.
  [[nodiscard]] bool factor(const Matrix& matrix) {
    factors_ = matrix;
    const Eigen::Index n = factors_.rows();
    determinant_ = 1.0;
    for (Eigen::Index k = 0; k < n; ++k) {
      Eigen::Index pivot = k;
      const double largest = factors_.col(k).tail(n - k).cwiseAbs().maxCoeff(&pivot);
      pivot += k;
      if (!(largest > 0.0) || !std::isfinite(largest)) {
        determinant_ = 0.0;
        return false;
      }
      swaps_[static_cast<std::size_t>(k)] = pivot;
      if (pivot != k) {
        for (Eigen::Index j = 0; j < n; ++j) std::swap(factors_(k, j), factors_(pivot, j));
        determinant_ = -determinant_;
      }
      determinant_ *= factors_(k, k);
      factors_.col(k).tail(n - k - 1) /= factors_(k, k);
      for (Eigen::Index j = k + 1; j < n; ++j) {
        const double factor = factors_(k, j);
        if (factor == 0.0) continue;
        for (Eigen::Index i = k + 1; i < n; ++i) factors_(i, j) -= factor * factors_(i, k);
      }
    }
    return true;
  }

  /// b becomes the solution x of A x = b.
  void solve(Eigen::Ref<Eigen::VectorXd> b) const {
    const Eigen::Index n = factors_.rows();
    for (Eigen::Index k = 0; k < n; ++k) std::swap(b[k], b[swaps_[static_cast<std::size_t>(k)]]);
    for (Eigen::Index k = 0; k < n; ++k) {
      for (Eigen::Index i = k + 1; i < n; ++i) b[i] -= factors_(i, k) * b[k];
    }
    for (Eigen::Index k = n - 1; k >= 0; --k) {
      b[k] /= factors_(k, k);
      for (Eigen::Index i = 0; i < k; ++i) b[i] -= factors_(i, k) * b[k];
    }
  }

  /// b becomes the solution x of A^T x = b.
  void solve_transposed(Eigen::Ref<Eigen::VectorXd> b) const {
    const Eigen::Index n = factors_.rows();
    for (Eigen::Index k = 0; k < n; ++k) {
      for (Eigen::Index i = 0; i < k; ++i) b[k] -= factors_(i, k) * b[i];
      b[k] /= factors_(k, k);
    }
    for (Eigen::Index k = n - 1; k >= 0; --k) {
      for (Eigen::Index i = k + 1; i < n; ++i) b[k] -= factors_(i, k) * b[i];
    }
    for (Eigen::Index k = n - 1; k >= 0; --k) {
      std::swap(b[k], b[swaps_[static_cast<std::size_t>(k)]]);
    }
  }

  [[nodiscard]] double determinant() const { return determinant_; }

 private:
  Matrix factors_;  ///< L below the diagonal, its ones left out, and U
  std::array<Eigen::Index, static_cast<std::size_t>(kCapacity)> swaps_{};
  double determinant_ = 0.0;
};

}  // namespace softfinger
