#include <algorithm>
#include <cmath>
#include <numbers>

#include "softfinger/device/kinds/platform_3rrs.hpp"
#include "softfinger/device/workspace.hpp"

namespace softfinger {
namespace {

// Limits count as inside to this much (rad): rounding of degrees in files and flags must not put a
// pose on its limit out of the workspace.
constexpr double kTolerance = 1e-9;

Configuration between(const Configuration& from, const Configuration& to, double fraction) {
  return from + fraction * (to - from);
}

}  // namespace

bool Platform3rrs::locally_reachable(const Configuration& q) const {
  if (!q.allFinite() || std::hypot(q[0], q[1]) > geometry_.max_tilt + kTolerance) return false;
  JointAngles joints;
  if (!inverse_kinematics(q, joints)) return false;
  for (int leg = 0; leg < 3; ++leg) {
    if (joints[leg] < joint_limits().min[leg] - kTolerance ||
        joints[leg] > joint_limits().max[leg] + kTolerance) {
      return false;
    }
  }
  return !may_be_singular_ || singularity_ratio(q) > 0.0;
}

bool Platform3rrs::segment_reachable(const Configuration& from, const Configuration& to,
                                     int pieces) const {
  for (int piece = 1; piece < pieces; ++piece) {
    if (!locally_reachable(between(from, to, static_cast<double>(piece) / pieces))) return false;
  }
  return true;
}

bool Platform3rrs::reachable(const Configuration& q) const {
  if (q.size() != 3 || home_determinant_ == 0.0 || !locally_reachable(q)) return false;
  return grid_.all_connected || connected_with_home(q);
}

bool Platform3rrs::connected_with_home(const Configuration& q) const {
  if (segment_reachable(home(), q, 64)) return true;
  std::array<int, 3> corner{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<int>(k);
    corner[k] =
        static_cast<int>(std::floor((q[axis] - home()[axis]) / grid_.spacing[k])) - grid_.low[k];
  }
  for (int choice = 0; choice < 8; ++choice) {
    const std::array<int, 3> node{corner[0] + (choice & 1), corner[1] + ((choice >> 1) & 1),
                                  corner[2] + ((choice >> 2) & 1)};
    bool on_grid = true;
    Configuration at = home();
    std::size_t index = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      on_grid = on_grid && node[k] >= 0 && node[k] < grid_.count[k];
      if (!on_grid) break;
      at[static_cast<int>(k)] += grid_.spacing[k] * (node[k] + grid_.low[k]);
      index = index * static_cast<std::size_t>(grid_.count[k]) + static_cast<std::size_t>(node[k]);
    }
    if (on_grid && grid_.inside[index] == 2 && segment_reachable(at, q, 8)) return true;
  }
  return false;
}

// Marks the nodes of a grid through home that are connected with it: 1 locally reachable, 2
// connected.
void Platform3rrs::explore_workspace() {
  const double reach = geometry_.crank + geometry_.coupler;
  const double level = geometry_.max_tilt;
  // Travel between the two mirror poses of fully stretched legs, with room for the tilt.
  const double deepest =
      geometry_.neutral_height - reach - geometry_.platform_radius * std::sin(level);
  const double highest =
      geometry_.neutral_height + reach + geometry_.platform_radius * std::sin(level);
  grid_.spacing = {level / 12.0, level / 12.0, (highest - deepest) / 80.0};
  const std::array<double, 3> from{-level, -level, deepest};
  const std::array<double, 3> to{level, level, highest};
  std::size_t size = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double origin = home()[static_cast<int>(k)];
    grid_.low[k] = static_cast<int>(std::ceil((from[k] - origin) / grid_.spacing[k]));
    grid_.count[k] = std::max(
        1, static_cast<int>(std::floor((to[k] - origin) / grid_.spacing[k])) - grid_.low[k] + 1);
    size *= static_cast<std::size_t>(grid_.count[k]);
  }
  grid_.inside.assign(size, 0);
  const auto stride0 =
      static_cast<std::size_t>(grid_.count[1]) * static_cast<std::size_t>(grid_.count[2]);
  const auto stride1 = static_cast<std::size_t>(grid_.count[2]);
  const auto configuration_at = [&](std::size_t index) {
    Configuration q = home();
    q[0] += grid_.spacing[0] * (static_cast<int>(index / stride0) + grid_.low[0]);
    q[1] += grid_.spacing[1] *
            (static_cast<int>(index / stride1 % static_cast<std::size_t>(grid_.count[1])) +
             grid_.low[1]);
    q[2] += grid_.spacing[2] * (static_cast<int>(index % stride1) + grid_.low[2]);
    return q;
  };

  double least_ratio = 1.0;
  for (std::size_t index = 0; index < size; ++index) {
    const Configuration q = configuration_at(index);
    if (!locally_reachable(q)) continue;
    grid_.inside[index] = 1;
    least_ratio = std::min(least_ratio, singularity_ratio(q));
  }
  may_be_singular_ = least_ratio < 0.25;

  std::array<std::size_t, 3> home_node{};
  for (std::size_t k = 0; k < 3; ++k) {
    home_node[k] = static_cast<std::size_t>(std::clamp(-grid_.low[k], 0, grid_.count[k] - 1));
  }
  std::vector<std::size_t> open{home_node[0] * stride0 + home_node[1] * stride1 + home_node[2]};
  grid_.inside[open.front()] = 2;
  while (!open.empty()) {
    const std::size_t index = open.back();
    open.pop_back();
    const std::array<std::size_t, 3> node{
        index / stride0, index / stride1 % static_cast<std::size_t>(grid_.count[1]),
        index % stride1};
    const std::array<std::size_t, 3> strides{stride0, stride1, 1};
    for (std::size_t k = 0; k < 3; ++k) {
      for (const bool up : {false, true}) {
        if (up ? node[k] + 1 >= static_cast<std::size_t>(grid_.count[k]) : node[k] == 0) continue;
        const std::size_t next = up ? index + strides[k] : index - strides[k];
        if (grid_.inside[next] != 1) continue;
        if (!locally_reachable(between(configuration_at(index), configuration_at(next), 0.5)))
          continue;
        grid_.inside[next] = 2;
        open.push_back(next);
      }
    }
  }
  grid_.all_connected =
      std::find(grid_.inside.begin(), grid_.inside.end(), 1) == grid_.inside.end();
}

std::optional<PlatformSpace> Platform3rrs::platform_space() const {
  const double reach = geometry_.crank + geometry_.coupler;
  return space_of({.pitch = 0, .roll = 1, .travel = 2}, geometry_.neutral_height - reach,
                  geometry_.neutral_height + reach, geometry_.max_tilt);
}

}  // namespace softfinger
