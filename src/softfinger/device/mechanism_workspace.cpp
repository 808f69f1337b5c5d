#include <algorithm>
#include <cmath>
#include <numbers>

#include "softfinger/device/mechanism.hpp"
#include "softfinger/device/workspace.hpp"

namespace softfinger {
namespace {

constexpr double kPiecesASpacing = 4.0;  // looks at limits on the way between grid and q
constexpr double kFarthestTravel = 4.0;  // of the linkage's length, from home

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
  grid_.load(node, solution);
  const LinkageInputs from = solution.values;
  const int pieces =
      1 + static_cast<int>(std::min(kPiecesASpacing * grid_.spacings(wanted, from), 256.0));
  for (int piece = 1; piece <= pieces; ++piece) {
    const LinkageInputs at = from + (static_cast<double>(piece) / pieces) * (wanted - from);
    if (!linkage.follow(description_.configuration, at, solution) || !within_limits(solution)) {
      return false;
    }
  }
  return true;
}

WorkspaceSummary Mechanism::workspace_summary() const {
  int roll = -1;
  int pitch = -1;
  for (int k = 0; k < degrees_of_freedom(); ++k) {
    const LinkageReading& reading = description_.configuration[static_cast<std::size_t>(k)];
    if (reading.kind != LinkageReading::Kind::kRotation) continue;
    if (reading.body != description_.surface.front().body) continue;
    if (reading.component == 0) roll = k;
    if (reading.component == 1) pitch = k;
  }
  const int travel = approach_axis();
  const double start = travel >= 0 ? home()[travel] : 0.0;
  const double reach = kFarthestTravel * description_.linkage.linkage().length();
  // Rotations that the configuration does not name cannot be asked for.
  const auto reached = [&](double wanted_pitch, double wanted_roll, double wanted_travel) {
    Configuration q = home();
    for (const auto& [axis, wanted] :
         {std::pair(pitch, wanted_pitch), std::pair(roll, wanted_roll)}) {
      if (axis >= 0) q[axis] = wanted;
      if (axis < 0 && std::abs(wanted) > 1e-12) return false;
    }
    if (travel >= 0) q[travel] = wanted_travel;
    if (travel < 0 && wanted_travel != start) return false;
    return reachable(q);
  };
  return summarise_platform_workspace(
      reached, start - reach, start + reach, start,
      description_.tilt ? description_.tilt->max_tilt : 0.5 * std::numbers::pi);
}

}  // namespace softfinger
