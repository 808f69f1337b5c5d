#include <algorithm>
#include <cmath>
#include <numbers>

#include "softfinger/device/mechanism/mechanism.hpp"
#include "softfinger/device/workspace.hpp"

namespace softfinger {
namespace {

constexpr double kPiecesASpacing = 4.0;     // looks at limits on the way between grid and q
constexpr double kReachStep = 1.0 / 256.0;  // of the farthest that is looked at
constexpr double kFarthestTravel = 4.0;     // of the linkage's length, from home

}  // namespace

bool Mechanism::reachable(const Configuration& q) const {
  if (q.size() != degrees_of_freedom() || !q.allFinite()) return false;
  const LinkageInputs wanted = q;
  LinkageSolution solution;
  if (!solve(q, solution) || !within_limits(solution)) return false;
  if (grid_.surrounded(wanted)) return true;

  // From the nearest of the connected configurations on the way to home.
  const ClosedLinkage& linkage = description_.linkage;
  const SolvedGrid::Node& node = grid_.start(wanted, true);
  if (!node.inside) return false;
  // The solution above came from there along the same line.
  const bool came = &node == &grid_.start(wanted, false);
  grid_.load(node, solution);
  const LinkageInputs from = solution.values;
  const int pieces =
      1 + static_cast<int>(std::min(kPiecesASpacing * grid_.spacings(wanted, from), 256.0));
  for (int piece = 1; piece <= (came ? pieces - 1 : pieces); ++piece) {
    const LinkageInputs at = from + (static_cast<double>(piece) / pieces) * (wanted - from);
    if (!linkage.follow(description_.configuration, at, solution) || !within_limits(solution)) {
      return false;
    }
  }
  return true;
}

std::optional<PlatformSpace> Mechanism::platform_space() const {
  PlatformAxes axes{.travel = approach_axis()};
  for (int k = 0; k < degrees_of_freedom(); ++k) {
    const LinkageReading& reading = description_.configuration[static_cast<std::size_t>(k)];
    if (reading.kind != LinkageReading::Kind::kRotation) continue;
    if (reading.body != description_.surface.front().body) continue;
    if (reading.component == 0) axes.roll = k;
    if (reading.component == 1) axes.pitch = k;
  }
  if (axes.roll < 0 || axes.pitch < 0 || axes.travel < 0) return std::nullopt;
  const double reach = kFarthestTravel * description_.linkage.linkage().length();
  return space_of(axes, home()[axes.travel] - reach, home()[axes.travel] + reach,
                  description_.tilt ? description_.tilt->max_tilt : 0.5 * std::numbers::pi);
}

std::vector<AxisReach> Mechanism::reaches() const {
  std::vector<AxisReach> reaches;
  const Linkage& linkage = description_.linkage.linkage();
  for (int k = 0; k < degrees_of_freedom(); ++k) {
    const ConfigurationAxis& axis = axes()[static_cast<std::size_t>(k)];
    const double farthest =
        linkage.is_angle(description_.configuration[static_cast<std::size_t>(k)])
            ? std::numbers::pi
            : kFarthestTravel * linkage.length();
    const auto end = [&](double side) {
      const auto reached = [&](double part) {
        Configuration q = home();
        q[k] += part * side * farthest;
        return reachable(q);
      };
      double inside = 0.0;
      while (inside < 1.0 && reached(inside + kReachStep)) inside += kReachStep;
      double outside = std::min(1.0, inside + kReachStep);
      for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (inside + outside);
        (reached(middle) ? inside : outside) = middle;
      }
      return home()[k] + inside * side * farthest;
    };
    reaches.push_back({axis.name, end(-1.0), end(1.0), axis.unit()});
  }
  return reaches;
}

}  // namespace softfinger
