#include "softfinger/actuation/travel_ceiling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

/// Each step is as long as there is room, so that none goes past the first touch; where the gap
/// falls as the advance grows the second is the last.
constexpr int kSteps = 32;
constexpr double kTouching = 1e-7;  // m
/// Between the places where a linkage is asked whether it closes.
constexpr double kAsked = 0.5 * mm;

}  // namespace

TravelCeiling::TravelCeiling(std::shared_ptr<const Device> device,
                             std::span<const Vector3> rest_skin, std::vector<GridAxis> grid,
                             std::vector<double> depths)
    : device_(std::move(device)), grid_(std::move(grid)), depths_(std::move(depths)) {
  for (const Vector3& point : rest_skin) {
    x_.push_back(point.x());
    y_.push_back(point.y());
    z_.push_back(point.z());
  }
  skin_.x = x_;
  skin_.y = y_;
  skin_.z = z_;
}

std::vector<Vector3> TravelCeiling::rest_skin() const {
  std::vector<Vector3> points;
  for (std::size_t k = 0; k < x_.size(); ++k) points.emplace_back(x_[k], y_[k], z_[k]);
  return points;
}

double TravelCeiling::depth(const Configuration& q) const {
  const int axis = device_->approach_axis();
  if (axis < 0) return q.maxCoeff();
  return (q[axis] - first_touch(q)) * device_->axes()[static_cast<std::size_t>(axis)].metric;
}

double TravelCeiling::limit(const Configuration& q) const {
  std::array<double, kMostAxes> fraction{};
  std::array<std::size_t, kMostAxes> stride{};
  std::size_t first = 0;  // the cell's corner of least index
  std::size_t size = 1;
  for (std::size_t k = 0; k < grid_.size(); ++k) {
    const GridAxis& axis = grid_[k];
    const double place =
        std::clamp((q[axis.axis] - axis.min) / (axis.max - axis.min), 0.0, 1.0) * (axis.count - 1);
    const int cell = std::min(static_cast<int>(place), axis.count - 2);
    fraction[k] = place - cell;
    stride[k] = size;
    first += static_cast<std::size_t>(cell) * size;
    size *= static_cast<std::size_t>(axis.count);
  }
  double sum = 0.0;
  for (std::size_t corner = 0; corner < (std::size_t{1} << grid_.size()); ++corner) {
    double weight = 1.0;
    std::size_t index = first;
    for (std::size_t k = 0; k < grid_.size(); ++k) {
      const bool upper = ((corner >> k) & 1U) != 0;
      weight *= upper ? fraction[k] : 1.0 - fraction[k];
      if (upper) index += stride[k];
    }
    if (weight > 0.0) sum += weight * depths_[index];
  }
  return sum;
}

double TravelCeiling::excess(const Configuration& q) const {
  const int axis = device_->approach_axis();
  if (axis < 0) return q.maxCoeff() - depths_[0];
  return (q[axis] - travel(q)) * device_->axes()[static_cast<std::size_t>(axis)].metric;
}

void TravelCeiling::lower(Configuration& q, double margin) const {
  if (device_->approach_axis() < 0) {
    q = q.cwiseMin(depths_[0] - margin);
    return;
  }
  const double over = excess(q) + margin;
  if (over > 0.0) device_->advance(-(over + kTouching), q);
}

// From afar, which is where the linkage closes first: aside of home it may not reach so far back.
double TravelCeiling::first_touch(const Configuration& q) const {
  const int axis = device_->approach_axis();
  const double farthest = device_->axes()[static_cast<std::size_t>(axis)].max;
  Configuration at = q;
  at[axis] = std::min(device_->home()[axis], device_->retracted()[axis]);
  JointAngles joints;
  while (at[axis] < farthest && !device_->inverse_kinematics(at, joints)) {
    device_->advance(kAsked, at);
  }
  for (int i = 0; i < kSteps && at[axis] < farthest; ++i) {
    const double room = device_->least_distance(at, skin_);
    if (std::abs(room) < kTouching) break;
    device_->advance(room, at);
  }
  return std::min(at[axis], farthest);
}

double TravelCeiling::travel(const Configuration& q) const {
  const int axis = device_->approach_axis();
  if (axis < 0) return depths_[0];
  const ConfigurationAxis& advanced = device_->axes()[static_cast<std::size_t>(axis)];
  return std::min(first_touch(q) + limit(q) / advanced.metric, advanced.max);
}

}  // namespace softfinger
