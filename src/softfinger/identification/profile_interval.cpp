#include "softfinger/identification/profile_interval.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace softfinger {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostTrials = 8;
constexpr int kMostCorrections = 4;
constexpr double kGreatestStretch = 3.0;  // of the distance from one trial to the next
constexpr double kAgreement = 0.08;       // of t
constexpr double kLeastResidual = 1e-9;   // residuals that vanish still leave a scale

/// Sum of squares along one unknown, the others fitted with the Jacobian of the minimum.
class Profile {
 public:
  Profile(const LeastSquaresProblem& problem, const LeastSquaresSolution& solution, Index i)
      : problem_(problem), solution_(solution), i_(i) {
    const Index n = solution.x.size();
    for (Index k = 0; k < n; ++k) {
      if (k != i) others_.push_back(k);
    }
    const auto freedom = static_cast<double>(solution.residuals.size() - n);
    noise_ = std::max(std::sqrt(solution.sum_of_squares() / freedom), kLeastResidual);
    if (!others_.empty()) qr_.compute(MatrixXd(solution.jacobian(Eigen::all, others_)));
  }

  /// s sqrt((J^T J)^-1_ii); infinite where the unknown has no influence of its own.
  [[nodiscard]] double standard_error() const {
    const VectorXd own = solution_.jacobian.col(i_);
    VectorXd left = own;
    if (!others_.empty()) left -= solution_.jacobian(Eigen::all, others_) * qr_.solve(own);
    if (left.norm() <= 1e-6 * own.norm()) return std::numeric_limits<double>::infinity();
    return noise_ / left.norm();
  }

  /// Square root of the rise of the sum of squares, in units of the noise.
  [[nodiscard]] std::optional<double> rise(double value) const {
    VectorXd x = solution_.x;
    x[i_] = value;
    const VectorXd expected =
        solution_.residuals + solution_.jacobian.col(i_) * (value - solution_.x[i_]);
    x += step_of_others(x, expected);
    VectorXd residuals = problem_.residuals(x);
    if (residuals.size() == 0) return std::nullopt;
    for (int k = 0; k < kMostCorrections && !others_.empty(); ++k) {
      const VectorXd next = x + step_of_others(x, residuals);
      const VectorXd corrected = problem_.residuals(next);
      if (corrected.size() == 0) break;
      const double gain = residuals.squaredNorm() - corrected.squaredNorm();
      if (gain <= 0.0) break;
      x = next;
      residuals = corrected;
      if (gain < 0.05 * noise_ * noise_) break;
    }
    const double above = residuals.squaredNorm() - solution_.sum_of_squares();
    return std::sqrt(std::max(above, 0.0)) / noise_;
  }

 private:
  [[nodiscard]] VectorXd step_of_others(const VectorXd& x, const VectorXd& residuals) const {
    return bounded_step(problem_, x, residuals, solution_.jacobian, 0.0, others_);
  }

  const LeastSquaresProblem& problem_;
  const LeastSquaresSolution& solution_;
  Index i_;
  std::vector<Index> others_;
  Eigen::ColPivHouseholderQR<MatrixXd> qr_;
  double noise_ = 0.0;
};

struct End {
  double value = 0.0;
  bool open = false;
};

/// Where the rise reaches t, going from `from` towards `bound`.
End find_end(const Profile& profile, double from, double bound, double first, double t) {
  const double side = bound > from ? 1.0 : -1.0;
  const double furthest = std::abs(bound - from);
  double inside = 0.0, rise_inside = 0.0;
  std::optional<double> outside;
  double rise_outside = 0.0;
  double distance = std::min(first, furthest);
  for (int trial = 0; trial < kMostTrials; ++trial) {
    if (distance <= 0.0) return {bound, true};
    const auto rise = profile.rise(from + side * distance);
    if (!rise) return {from + side * distance, true};
    if (std::abs(*rise - t) <= kAgreement * t) break;
    if (*rise < t) {
      if (distance >= furthest) return {bound, true};
      inside = distance;
      rise_inside = *rise;
    } else {
      outside = distance;
      rise_outside = *rise;
    }
    if (outside) {
      const double share = (t - rise_inside) / (rise_outside - rise_inside);
      distance = inside + std::clamp(share, 0.1, 0.9) * (*outside - inside);
    } else {
      const double stretch = std::min(kGreatestStretch, t / std::max(*rise, 1e-3 * t));
      distance = std::min(furthest, std::max(stretch, 1.1) * distance);
    }
  }
  return {from + side * distance, false};
}

}  // namespace

ConfidenceInterval profile_interval(const LeastSquaresProblem& problem,
                                    const LeastSquaresSolution& solution, Index i, double level) {
  const double x = solution.x[i];
  const Profile profile(problem, solution, i);
  const auto freedom = static_cast<double>(solution.residuals.size() - solution.x.size());
  const double t = student_t_quantile(0.5 + 0.5 * level, freedom);
  const double first = t * profile.standard_error();
  if (!std::isfinite(first)) return {problem.lower[i], problem.upper[i], true, true};
  const End low = find_end(profile, x, problem.lower[i], first, t);
  const End high = find_end(profile, x, problem.upper[i], first, t);
  return {low.value, high.value, low.open, high.open};
}

}  // namespace softfinger
