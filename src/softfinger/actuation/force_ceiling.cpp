#include "softfinger/actuation/force_ceiling.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/base/stop_check.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/rest_skin.hpp"
#include "softfinger/threads/parallel_for.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
/// The device cannot press that hard anywhere.
constexpr double kNoLimit = 1.0;  // m
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Values per grid axis, by the number of axes: of angles, and the most of lengths, between which
/// there are kSpacing as far as that. A tip that is moved aside goes around the bone.
constexpr std::array<int, TravelCeiling::kMostAxes + 1> kAngles = {1, 9, 5, 3, 3, 2, 2};
constexpr std::array<int, TravelCeiling::kMostAxes + 1> kMostLengths = {1, 33, 17, 3, 3, 2, 2};
constexpr double kSpacing = 1.0 * mm;
/// The table is made for this part of the limit, for what happens between its nodes; where a tip is
/// moved aside, forces change more from node to node.
constexpr double kReserve = 0.93;
constexpr double kReserveAside = 0.75;
constexpr int kProbes = 40;                      // of how far an axis goes
constexpr double kFarthestLookedAt = 20.0 * mm;  // of surface motion from home that is looked at
constexpr double kMarch = 0.5 * mm;              // of advance between two presses
constexpr double kLeastMarch = 0.1 * mm;
constexpr double kAdvanceTolerance = 3e-5;  // m
constexpr double kNearEnough = 0.01;        // of the force looked for

/// The one number that says how far a device is advanced.
struct Advance {
  explicit Advance(const Device& device)
      : axis(device.approach_axis()),
        metric(device.axes()[static_cast<std::size_t>(std::max(axis, 0))].metric) {}

  void set(double value, Configuration& q) const {
    if (axis >= 0) {
      q[axis] = value;
    } else {
      q.setConstant(value);
    }
  }
  [[nodiscard]] double of(const Configuration& q) const {
    return axis >= 0 ? q[axis] : q.maxCoeff();
  }

  int axis;
  double metric;  ///< m per SI unit
};

struct Span {
  double min, max;
};

/// Widens `span` by those of `count` values of component k within its axis' limits that `holds`
/// for, other components as in q. k: -1: the advance.
template <typename Holds>
void widen(const Device& device, const Advance& advance, const Configuration& q, int k,
           const Holds& holds, Span& span) {
  const ConfigurationAxis& axis = device.axes()[static_cast<std::size_t>(std::max(k, 0))];
  const double home = k < 0 ? advance.of(device.home()) : device.home()[k];
  const double far = kFarthestLookedAt / axis.metric;
  const double min = std::max(axis.min, home - far);
  const double max = std::min(axis.max, home + far);
  for (int i = 0; i <= kProbes; ++i) {
    const double value = min + (max - min) * i / kProbes;
    Configuration probe = q;
    if (k < 0) {
      advance.set(value, probe);
    } else {
      probe[k] = value;
    }
    if (!holds(probe)) continue;
    span.min = std::min(span.min, value);
    span.max = std::max(span.max, value);
  }
}

/// How far the device can be advanced while its linkage closes, other components as in q.
Span advance_span(const Device& device, const Advance& advance, const Configuration& q) {
  Span span{kInfinity, -kInfinity};
  JointAngles joints;
  widen(
      device, advance, q, advance.axis,
      [&](const Configuration& probe) { return device.inverse_kinematics(probe, joints); }, span);
  return span;
}

/// How far component k goes within the workspace, at any advance, others at home.
Span reach_span(const Device& device, const Advance& advance, int k) {
  const Span travel = advance_span(device, advance, device.home());
  Span span{device.home()[k], device.home()[k]};
  for (int i = 0; i <= kProbes; ++i) {
    Configuration q = device.home();
    advance.set(travel.min + (travel.max - travel.min) * i / kProbes, q);
    widen(
        device, advance, q, k, [&](const Configuration& probe) { return device.reachable(probe); },
        span);
  }
  return span;
}

/// The twin's normal force with the device advanced, and its derivative by the advance, N and N by
/// m or rad.
struct Pressing {
  double force = 0.0;
  double rate = 0.0;
};

Pressing press(Twin& twin, const Advance& advance, const Configuration& q) {
  twin.begin_frame(0.0, 0.0);
  twin.attempt(q);
  Pressing pressing{twin.contact().normal_force, 0.0};
  Vector3 force;
  SurfaceJacobian by_q;
  if (pressing.force > 0.0 && twin.force_and_derivative(force, by_q)) {
    Configuration ahead = Configuration::Zero(q.size());
    advance.set(1.0, ahead);
    pressing.rate = force.normalized().dot(by_q * ahead);
  }
  return pressing;
}

/// The advance at which the twin feels `max_force`, for the other components as in q; missing where
/// it feels that nowhere. The device comes from afar, in steps that its solid cannot jump the skin
/// by.
double ceiling_at(Twin& twin, Configuration q, const Advance& advance, const Span& span,
                  double max_force, const std::stop_token& stop) {
  advance.set(span.min, q);
  twin.reset(q);
  const double tolerance = kAdvanceTolerance / advance.metric;
  const double longest = kMarch / advance.metric;
  const double least = kLeastMarch / advance.metric;
  double low = -kInfinity;  // presses with no more than max_force, and does further off
  double high = kInfinity;  // presses with more
  double value = span.min;
  while (true) {
    advance.set(value, q);
    const Pressing pressing = press(twin, advance, q);
    StopCheck::now(stop);  // then it was broken off, and says nothing
    if (pressing.force > max_force) {
      high = value;
      if (value == span.min) return span.min;
    } else {
      low = value;
      if (value == span.max) return kMissing;
    }
    if (high - low <= tolerance) return low;
    if (low == value && pressing.force >= (1.0 - kNearEnough) * max_force) return low;
    // Of a round body in contact the root of the force is nearly straight.
    const double root = std::sqrt(pressing.force);
    double step = 2.0 * root * (std::sqrt(max_force) - root) / pressing.rate;
    if (pressing.force <= 0.0) {
      // As far as there is room nothing is pressed.
      const double gap = twin.contact().least_gap;
      step = std::max(longest, std::isfinite(gap) ? gap / advance.metric : 0.0);
    } else if (!(pressing.rate > 0.0)) {
      step = longest;
    } else if (std::isinf(high)) {
      // Where one vertex has just begun to touch, force says nothing yet of what follows.
      step = std::clamp(step, least, longest);
    }
    value = std::min(value + step, span.max);
    if (!(value > low && value < high)) value = std::isfinite(high) ? 0.5 * (low + high) : span.max;
  }
}

int grid_count(const Device& device, int k, const Span& span, int axes) {
  const auto number = static_cast<std::size_t>(axes);
  if (device.axes()[static_cast<std::size_t>(k)].angular) return kAngles[number];
  const int spaces = static_cast<int>(std::ceil((span.max - span.min) / kSpacing));
  return std::clamp(1 + spaces, 2, kMostLengths[number]);
}

std::vector<TravelCeiling::GridAxis> grid_axes(const Device& device, const Advance& advance) {
  if (advance.axis < 0) return {};
  const int others = device.degrees_of_freedom() - 1;
  if (others > TravelCeiling::kMostAxes) {
    throw InputError(
        fmt::format("cannot be kept by a device with {} axes beside the one that advances it, at "
                    "most {}",
                    others, TravelCeiling::kMostAxes));
  }
  std::vector<TravelCeiling::GridAxis> axes;
  for (int k = 0; k < device.degrees_of_freedom(); ++k) {
    if (k == advance.axis) continue;
    const Span span = reach_span(device, advance, k);
    if (!(span.max > span.min)) continue;
    axes.push_back({k, span.min, span.max, grid_count(device, k, span, others)});
  }
  return axes;
}

/// Points of a regular grid, first axis fastest.
class Grid {
 public:
  /// The nodes of these axes, or the centres between them.
  Grid(std::vector<TravelCeiling::GridAxis> axes, bool centres) : axes_(std::move(axes)) {
    if (!centres) return;
    for (TravelCeiling::GridAxis& axis : axes_) {
      const double half = 0.5 * (axis.max - axis.min) / (axis.count - 1);
      axis = {axis.axis, axis.min + half, axis.max - half, axis.count - 1};
    }
  }

  [[nodiscard]] std::size_t size() const { return size_of(axes_.size()); }
  /// Points along the first axis.
  [[nodiscard]] std::size_t line() const { return size_of(std::min<std::size_t>(axes_.size(), 1)); }
  [[nodiscard]] std::size_t axes() const { return axes_.size(); }
  [[nodiscard]] int count(std::size_t k) const { return axes_[k].count; }
  [[nodiscard]] std::size_t stride(std::size_t k) const { return size_of(k); }
  [[nodiscard]] int place(std::size_t point, std::size_t k) const {
    return static_cast<int>(point / stride(k)) % axes_[k].count;
  }
  void set(std::size_t point, Configuration& q) const {
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      const TravelCeiling::GridAxis& axis = axes_[k];
      const double part =
          axis.count > 1 ? static_cast<double>(place(point, k)) / (axis.count - 1) : 0.0;
      q[axis.axis] = axis.min + (axis.max - axis.min) * part;
    }
  }

 private:
  [[nodiscard]] std::size_t size_of(std::size_t axes) const {
    std::size_t product = 1;
    for (std::size_t k = 0; k < axes; ++k) product *= static_cast<std::size_t>(axes_[k].count);
    return product;
  }

  std::vector<TravelCeiling::GridAxis> axes_;
};

/// Depths (see TravelCeiling) at the points of a grid; missing where the linkage does not close, or
/// the device does not press that hard. Each line by itself, so that the answer does not depend on
/// how many there are at a time.
std::vector<double> depths(const Grid& grid, const std::shared_ptr<const FingerModel>& wearer,
                           const std::shared_ptr<const Device>& device, const Advance& advance,
                           const TravelCeiling& skin, double max_force,
                           const std::stop_token& stop) {
  std::vector<double> values(grid.size(), kMissing);
  parallel_for(grid.size() / grid.line(), [&](std::size_t line) {
    Twin twin(wearer, device);
    twin.heed(stop);
    for (std::size_t point = line * grid.line(); point < (line + 1) * grid.line(); ++point) {
      Configuration q = device->home();
      grid.set(point, q);
      const Span span = advance_span(*device, advance, q);
      if (!(span.max > span.min)) continue;
      const double ceiling = ceiling_at(twin, q, advance, span, max_force, stop);
      if (std::isnan(ceiling)) continue;
      advance.set(ceiling, q);
      values[point] = skin.depth(q);
    }
  });
  return values;
}

/// Missing nodes get the least of their neighbours.
void fill_missing(const Grid& grid, std::vector<double>& values) {
  if (std::all_of(values.begin(), values.end(), [](double value) { return std::isnan(value); })) {
    values.assign(values.size(), kNoLimit);
  }
  bool missing = true;
  while (missing) {
    missing = false;
    const std::vector<double> before = values;
    for (std::size_t node = 0; node < values.size(); ++node) {
      if (!std::isnan(values[node])) continue;
      missing = true;
      for (std::size_t k = 0; k < grid.axes(); ++k) {
        const int place = grid.place(node, k);
        if (place > 0) values[node] = std::fmin(values[node], before[node - grid.stride(k)]);
        if (place + 1 < grid.count(k)) {
          values[node] = std::fmin(values[node], before[node + grid.stride(k)]);
        }
      }
    }
  }
}

/// Each node's least value of the nodes and centres next to it, so that interpolation in a cell
/// gives no more than the least that is known there.
std::vector<double> least_around(const Grid& nodes, const Grid& cells,
                                 const std::vector<double>& centres,
                                 const std::vector<double>& values) {
  std::vector<double> least = values;
  const std::size_t corners = std::size_t{1} << nodes.axes();
  for (std::size_t cell = 0; cell < centres.size(); ++cell) {
    const auto corner_of = [&](std::size_t corner) {
      std::size_t node = 0;
      for (std::size_t k = 0; k < nodes.axes(); ++k) {
        const auto place = static_cast<std::size_t>(cells.place(cell, k));
        node += (place + ((corner >> k) & 1U)) * nodes.stride(k);
      }
      return node;
    };
    double lowest = centres[cell];
    for (std::size_t corner = 0; corner < corners; ++corner) {
      lowest = std::fmin(lowest, values[corner_of(corner)]);
    }
    for (std::size_t corner = 0; corner < corners; ++corner) {
      double& value = least[corner_of(corner)];
      value = std::min(value, lowest);
    }
  }
  return least;
}

}  // namespace

std::shared_ptr<const FingerModel> stiffest_wearer(const FingerModel& model) {
  auto wearer = std::make_shared<FingerModel>(model);
  for (FingerModel::Material& material : wearer->materials) {
    material.youngs_modulus *= kStiffestWearer;
  }
  wearer->strain_limits.stiffness *= kStiffestWearer;
  return wearer;
}

TravelCeiling force_ceiling(const FingerModel& model, const std::shared_ptr<const Device>& device,
                            double max_force, const std::stop_token& stop) {
  if (!device->advances()) {
    throw InputError(
        "cannot be kept, no coordinate of this device is known to move its surface towards the "
        "finger; name it by [matching] approach, or leave it out");
  }
  const Advance advance(*device);
  const std::shared_ptr<const FingerModel> wearer = stiffest_wearer(model);
  const std::vector<TravelCeiling::GridAxis> axes = grid_axes(*device, advance);
  const Grid nodes(axes, false);
  const bool aside = std::any_of(axes.begin(), axes.end(), [&](const auto& axis) {
    return !device->axes()[static_cast<std::size_t>(axis.axis)].angular;
  });
  const double force = (aside ? kReserveAside : kReserve) * max_force;
  const std::vector<Vector3> rest_skin = rest_skin_points(model);
  const TravelCeiling skin(device, rest_skin, {}, {kNoLimit});
  std::vector<double> values = depths(nodes, wearer, device, advance, skin, force, stop);
  fill_missing(nodes, values);
  if (!axes.empty()) {
    const Grid cells(axes, true);
    values = least_around(nodes, cells, depths(cells, wearer, device, advance, skin, force, stop),
                          values);
  }
  TravelCeiling ceiling(device, rest_skin, axes, values);
  for (const Configuration& q : {device->home(), device->retracted()}) {
    if (ceiling.excess(q) <= 0.0) continue;
    throw InputError(
        fmt::format("{} N is exceeded already where the device rests; move "
                    "[home] and [retract] away from the finger, or the limit up",
                    max_force));
  }
  return ceiling;
}

}  // namespace softfinger
