#include "softfinger/loop/travel_offset.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softfinger {
namespace {

constexpr int kMostRepeats = 2;

}  // namespace

TravelOffset::TravelOffset(std::shared_ptr<const FingerModel> model,
                           std::shared_ptr<const Device> device, TravelOffsetOptions options)
    : options_(options), twin_(std::move(model), std::move(device)) {
  reset();
}

void TravelOffset::reset() {
  twin_.reset();
  value_ = 0.0;
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
  device.advance(value_, q);
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
  const double change = options_.gain * (reading.normal_force - predicted) / stiffness_;
  value_ += std::clamp(change, -options_.max_change, options_.max_change);
  value_ = std::clamp(value_, -options_.max_offset, options_.max_offset);
}

Configuration TravelOffset::corrected(const Configuration& q) const {
  Configuration result = q;
  twin_.device().advance(-value_, result);
  return result;
}

Configuration TravelOffset::felt(const Configuration& q) const {
  Configuration result = q;
  twin_.device().advance(value_, result);
  return result;
}

}  // namespace softfinger
