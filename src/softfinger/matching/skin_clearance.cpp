#include "softfinger/matching/skin_clearance.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

constexpr double kLeastStep = 50e-6;  // m, in search of where the skin is passed

}  // namespace

SkinClearance::SkinClearance(const Device& device, int capacity) : device_(device) {
  for (auto* array : {&x_, &y_, &z_}) array->resize(static_cast<std::size_t>(capacity));
}

void SkinClearance::take(const ContactSet& contact) {
  const std::size_t count = std::min(contact.samples.size(), x_.size());
  for (std::size_t i = 0; i < count; ++i) {
    x_[i] = contact.samples[i].position_F.x();
    y_[i] = contact.samples[i].position_F.y();
    z_[i] = contact.samples[i].position_F.z();
  }
  samples_ = {};
  samples_.x = {x_.data(), count};
  samples_.y = {y_.data(), count};
  samples_.z = {z_.data(), count};
}

double SkinClearance::gap(const Configuration& q) const {
  return device_.least_distance(q, samples_);
}

Configuration SkinClearance::with_gap(const Configuration& q, double wanted) const {
  if (!device_.advances() || samples_.size() == 0) return q;
  // From home's advance where q is further: a small tip that q has in the flesh, touching nothing,
  // would else be sent on through it.
  const int axis = device_.approach_axis();
  const double start =
      axis < 0 ? 0.0
               : std::min(0.0, (device_.home()[axis] - q[axis]) *
                                   device_.axes()[static_cast<std::size_t>(axis)].metric);
  const auto advanced = [&](double travel) {
    Configuration at = q;
    device_.advance(travel, at);
    return at;
  };
  const auto excess = [&](double travel) { return gap(advanced(travel)) - wanted; };
  double near = start;
  double near_excess = excess(near);
  if (near_excess == 0.0) return advanced(near);
  double far = near;
  double far_excess = near_excess;
  // Advancing, the surface comes nearer by at most as much as it moves: so steps of half as much
  // again as there is room pass the skin by no more than half of it, and going back a step of the
  // lack is never too long.
  double step = near_excess;
  for (int i = 0; i < 60 && (far_excess > 0.0) == (near_excess > 0.0); ++i) {
    near = far;
    near_excess = far_excess;
    far = near + step;
    far_excess = excess(far);
    step = near_excess > 0.0 ? std::max(1.5 * far_excess, kLeastStep) : 1.5 * step;
  }
  // Illinois' rule: regula falsi that halves the weight of a point that stays.
  for (int i = 0; i < 40 && std::abs(far - near) > 1e-10; ++i) {
    const double middle = far - far_excess * (far - near) / (far_excess - near_excess);
    const double value = excess(middle);
    if ((value > 0.0) == (far_excess > 0.0)) {
      near_excess *= 0.5;
    } else {
      near = far;
      near_excess = far_excess;
    }
    far = middle;
    far_excess = value;
    if (value == 0.0) break;
  }
  return advanced(far);
}

}  // namespace softfinger
