#include "softfinger/numerics/quadratic_program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softfinger {
namespace {

/// In-place lower Cholesky factor of the leading n x n block; false unless positive definite.
bool cholesky(Eigen::MatrixXd& m, Eigen::Index n) {
  for (Eigen::Index j = 0; j < n; ++j) {
    double pivot = m(j, j);
    for (Eigen::Index k = 0; k < j; ++k) pivot -= m(j, k) * m(j, k);
    // Relative to what was there: a pivot of pure rounding is no pivot.
    if (!(pivot > 1e-14 * std::abs(m(j, j)))) return false;
    pivot = std::sqrt(pivot);
    m(j, j) = pivot;
    for (Eigen::Index i = j + 1; i < n; ++i) {
      double sum = m(i, j);
      for (Eigen::Index k = 0; k < j; ++k) sum -= m(i, k) * m(j, k);
      m(i, j) = sum / pivot;
    }
  }
  return true;
}

template <typename Vector>
void solve_factored(const Eigen::MatrixXd& lower, Eigen::Index n, Vector& x) {
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < i; ++k) x[i] -= lower(i, k) * x[k];
    x[i] /= lower(i, i);
  }
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    for (Eigen::Index k = i + 1; k < n; ++k) x[i] -= lower(k, i) * x[k];
    x[i] /= lower(i, i);
  }
}

}  // namespace

QuadraticProgram::QuadraticProgram(int variables, int constraints)
    : variables_(variables),
      factor_(variables, variables),
      step_(variables),
      multipliers_(Eigen::VectorXd::Zero(constraints)),
      inverse_rows_(variables, variables),
      direction_(variables),
      combination_(variables),
      gram_(variables, variables) {
  active_.reserve(static_cast<std::size_t>(variables));
}

bool QuadraticProgram::factor(const Eigen::MatrixXd& B) {
  factor_ = B;
  return cholesky(factor_, variables_);
}

void QuadraticProgram::apply_inverse(Eigen::Ref<Eigen::VectorXd> vector) const {
  solve_factored(factor_, variables_, vector);
}

void QuadraticProgram::solve(const Eigen::VectorXd& g) {
  step_ = -g;
  apply_inverse(step_);
}

void QuadraticProgram::combine_active(int p, const Eigen::MatrixXd& A) {
  const auto count = static_cast<Eigen::Index>(active_.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    const int row = active_[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j <= i; ++j) gram_(i, j) = A.row(row).dot(inverse_rows_.col(j));
    combination_[i] = A.row(p).dot(inverse_rows_.col(i));
  }
  if (!cholesky(gram_, count)) {
    combination_.head(count).setZero();
    return;
  }
  solve_factored(gram_, count, combination_);
}

bool QuadraticProgram::solve(const Eigen::VectorXd& g, const Eigen::VectorXd& c,
                             const Eigen::MatrixXd& A) {
  const auto constraints = static_cast<int>(c.size());
  solve(g);
  const double reach = step_.cwiseAbs().maxCoeff();  // sets the size of rounding below
  multipliers_.setZero();
  active_.clear();
  const auto drop = [&](std::size_t which) {
    multipliers_[active_[which]] = 0.0;
    active_.erase(active_.begin() + static_cast<std::ptrdiff_t>(which));
    for (std::size_t k = which; k < active_.size(); ++k) {
      inverse_rows_.col(static_cast<Eigen::Index>(k)) =
          inverse_rows_.col(static_cast<Eigen::Index>(k) + 1);
    }
  };
  for (int round = 0; round < 10 * (constraints + 1); ++round) {
    int p = -1;
    double worst = 0.0;
    for (int k = 0; k < constraints; ++k) {
      const double violation = c[k] + A.row(k).dot(step_);
      const double size = std::abs(c[k]) + A.row(k).cwiseAbs().sum() * reach;
      if (violation > 1e-14 * size && violation > worst &&
          std::find(active_.begin(), active_.end(), k) == active_.end()) {
        worst = violation;
        p = k;
      }
    }
    if (p < 0) return true;
    for (;;) {
      // Move off constraint p without leaving the active ones.
      direction_ = A.row(p).transpose();
      apply_inverse(direction_);
      combine_active(p, A);
      const auto count = static_cast<Eigen::Index>(active_.size());
      const double free_curvature = A.row(p).dot(direction_);
      double curvature = free_curvature;
      for (Eigen::Index j = 0; j < count; ++j) {
        curvature -= combination_[j] * A.row(p).dot(inverse_rows_.col(j));
      }
      double dual_limit = std::numeric_limits<double>::infinity();
      std::size_t blocking = 0;
      for (std::size_t j = 0; j < active_.size(); ++j) {
        const double r = combination_[static_cast<Eigen::Index>(j)];
        if (r <= 0.0) continue;
        const double limit = multipliers_[active_[j]] / r;
        if (limit < dual_limit) {
          dual_limit = limit;
          blocking = j;
        }
      }
      const bool moves = count < variables_ && curvature > 1e-12 * free_curvature;
      const double violation = c[p] + A.row(p).dot(step_);
      const double primal_limit =
          moves ? violation / curvature : std::numeric_limits<double>::infinity();
      const double t = std::min(dual_limit, primal_limit);
      if (!std::isfinite(t)) return false;
      if (moves) {
        step_ -= t * direction_;
        for (Eigen::Index j = 0; j < count; ++j) {
          step_ += (t * combination_[j]) * inverse_rows_.col(j);
        }
      }
      for (Eigen::Index j = 0; j < count; ++j) {
        multipliers_[active_[static_cast<std::size_t>(j)]] -= t * combination_[j];
      }
      multipliers_[p] += t;
      if (t < primal_limit) {
        drop(blocking);
        continue;
      }
      inverse_rows_.col(count) = direction_;
      active_.push_back(p);
      break;
    }
  }
  return false;
}

}  // namespace softfinger
