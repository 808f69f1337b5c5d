#include "softfinger/loop/travel_offset.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softfinger {
namespace {

constexpr int kMostRepeats = 2;
/// What state changes by in a frame, over what a frame's measurement is wrong by: standard
/// deviations. The first make the filter learn a slip in some ten seconds of tilting.
constexpr double kSlipWander = 0.1;
constexpr double kNearnessWander = 0.6;
constexpr double kFirstSlip = 3.0;  ///< standard deviation of it before anything is known

}  // namespace

TravelOffset::TravelOffset(std::shared_ptr<const FingerModel> model,
                           std::shared_ptr<const Device> device, TravelOffsetOptions options)
    : options_(options), twin_(std::move(model), std::move(device)) {
  reset();
}

void TravelOffset::reset() {
  twin_.reset();
  state_.setZero();
  covariance_ = Vector3(kFirstSlip, kFirstSlip, 1.0).cwiseAbs2().asDiagonal();
  last_force_ = 0.0;
  repeats_ = 0;
  stiffness_ = options_.least_stiffness;
}

void TravelOffset::update(const ForceReading& reading, double friction_coefficient,
                          double elapsed) {
  if (!std::isfinite(reading.normal_force) || !reading.configuration.allFinite()) return;
  repeats_ = reading.normal_force == last_force_ ? repeats_ + 1 : 0;
  last_force_ = reading.normal_force;
  if (repeats_ >= kMostRepeats) return;
  const Device& device = twin_.device();
  Configuration q = reading.configuration;
  device.advance(at(q), q);
  twin_.press(q, friction_coefficient, elapsed);
  const double predicted = twin_.contact().normal_force;
  if (std::max(predicted, reading.normal_force) < options_.least_force) return;
  Vector3 force;
  SurfaceJacobian by_q;
  if (predicted > options_.least_force && twin_.force_and_derivative(force, by_q)) {
    Configuration ahead = Configuration::Zero(q.size());
    device.advance(1.0, ahead);
    const double slope = force.normalized().dot(by_q * ahead);
    if (std::isfinite(slope)) stiffness_ = std::max(slope, options_.least_stiffness);
  }
  change(weights(reading.configuration), (reading.normal_force - predicted) / stiffness_);
}

Vector3 TravelOffset::weights(const Configuration& q) const {
  if (!options_.refine) return Vector3::UnitZ();
  const Vector3 towards_F = twin_.device().surface_pose(q).rotation.col(2);
  return {towards_F.x(), towards_F.y(), 1.0};
}

/// By what is lacking, m.
void TravelOffset::change(const Vector3& weights, double lack) {
  if (!options_.refine) {
    state_.z() += std::clamp(options_.gain * lack, -options_.max_change, options_.max_change);
  } else {
    covariance_.diagonal() += Vector3(kSlipWander, kSlipWander, kNearnessWander).cwiseAbs2();
    const Vector3 spread = covariance_ * weights;
    const Vector3 gain = spread / (weights.dot(spread) + 1.0);
    covariance_ -= gain * spread.transpose();
    const double most = options_.max_change;
    state_ += gain * std::clamp(lack, -most, most);
  }
  const auto bound = [](double& value, double most) { value = std::clamp(value, -most, most); };
  bound(state_.x(), options_.max_slip);
  bound(state_.y(), options_.max_slip);
  bound(state_.z(), options_.max_offset);
}

double TravelOffset::at(const Configuration& q) const {
  const double value = weights(q).dot(state_);
  return std::clamp(value, -options_.max_offset, options_.max_offset);
}

Configuration TravelOffset::corrected(const Configuration& q) const {
  Configuration result = q;
  twin_.device().advance(-at(q), result);
  return result;
}

Configuration TravelOffset::felt(const Configuration& q) const {
  Configuration result = q;
  twin_.device().advance(at(q), result);
  return result;
}

}  // namespace softfinger
