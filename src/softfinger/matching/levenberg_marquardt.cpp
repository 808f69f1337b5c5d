#include "softfinger/matching/levenberg_marquardt.hpp"

#include <algorithm>

namespace softfinger {
namespace {

constexpr int kIterationLimit = 100;
// Damping, of the largest diagonal of J^T J: at first, its factor up and down, and where it ends.
constexpr double kFirstDamping = 1e-3;
constexpr double kFactor = 10.0;
constexpr double kLeastDamping = 1e-12;
constexpr double kMostDamping = 1e9;
constexpr double kLastStep = 1e-9;  // m of surface motion

}  // namespace

LevenbergMarquardt::LevenbergMarquardt(const Device& device)
    : device_(device),
      metric_(device.degrees_of_freedom()),
      gradient_(metric_.size()),
      gauss_newton_(metric_.size(), metric_.size()),
      hessian_(metric_.size(), metric_.size()),
      matrix_(metric_.size(), metric_.size()),
      program_(device.degrees_of_freedom(), 0) {
  for (int k = 0; k < metric_.size(); ++k) {
    metric_[k] = device.axes()[static_cast<std::size_t>(k)].metric;
  }
}

/// 2 J^T r and 2 J^T J at q.
void LevenbergMarquardt::expand(const Configuration& q, const SurfaceSamples& samples) {
  static_cast<void>(device_.deviation_derivatives(q, samples, gradient_, gauss_newton_, hessian_));
  for (int j = 0; j < metric_.size(); ++j) {
    gradient_[j] /= metric_[j];
    for (int i = 0; i < metric_.size(); ++i) gauss_newton_(i, j) /= metric_[i] * metric_[j];
  }
}

/// In program_.step().
bool LevenbergMarquardt::form_step(double damping) {
  matrix_ = gauss_newton_;
  matrix_.diagonal().array() += damping;
  if (!program_.factor(matrix_)) return false;
  program_.solve(gradient_);
  return true;
}

LevenbergMarquardt::Outcome LevenbergMarquardt::minimise(const SurfaceSamples& samples,
                                                         const Configuration& start) {
  Outcome outcome{.q = start, .deviation = device_.deviation(start, samples)};
  expand(outcome.q, samples);
  double damping = kFirstDamping;
  while (gradient_.squaredNorm() > 0.0) {
    if (outcome.iterations == kIterationLimit) {
      outcome.termination = Termination::kIterationLimit;
      break;
    }
    ++outcome.iterations;
    Configuration trial = outcome.q;
    double length = 0.0;
    bool lower = false;
    if (form_step(damping * gauss_newton_.diagonal().maxCoeff())) {
      const Eigen::VectorXd& step = program_.step();
      for (int k = 0; k < metric_.size(); ++k) trial[k] += step[k] / metric_[k];
      length = step.norm();
      const double deviation = device_.deviation(trial, samples);
      lower = deviation < outcome.deviation;
      if (lower) {
        outcome.q = trial;
        outcome.deviation = deviation;
        expand(outcome.q, samples);
        damping = std::max(damping / kFactor, kLeastDamping);
      }
      if (length < kLastStep) break;
    }
    if (lower) continue;
    damping *= kFactor;
    if (damping > kMostDamping) {
      outcome.termination = Termination::kNonsmooth;
      break;
    }
  }
  return outcome;
}

}  // namespace softfinger
