#include "softfinger/device/workspace.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace softfinger {
namespace {

constexpr double kRound = 2.0 * std::numbers::pi;

/// How finely a workspace is looked at.
struct Fineness {
  int travel_pieces;  ///< between low and high
  int tilt_pieces;    ///< of the largest tilt
  int halvings;       ///< of a piece in which the boundary lies
};
constexpr Fineness kForNumbers{2000, 60, 60};
constexpr Fineness kForDrawing{400, 12, 7};
constexpr int kLayers = 9;       // of travel, in an outline
constexpr int kDirections = 36;  // of tilt, in a layer

/// Last point still inside on the way from `inside` to `outside`.
template <typename Predicate>
double boundary(double inside, double outside, int halvings, Predicate&& reached) {
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    (reached(middle) ? inside : outside) = middle;
  }
  return inside;
}

/// Walks from `start`, which is inside, by `step` until it leaves or passes `end`.
template <typename Predicate>
double walk(double start, double end, double step, int halvings, Predicate&& reached) {
  double at = start;
  while (step > 0.0 ? at < end : at > end) {
    const double next = step > 0.0 ? std::min(at + step, end) : std::max(at + step, end);
    if (!reached(next)) return boundary(at, next, halvings, reached);
    at = next;
  }
  return at;
}

struct TravelRange {
  double min, max;
};
/// Travel at zero tilt; empty where there is none.
std::optional<TravelRange> travel_interval(const PlatformSpace& space, const Fineness& fineness) {
  const double step = (space.high - space.low) / fineness.travel_pieces;
  const auto level = [&](double travel) { return space.reachable(0.0, 0.0, travel); };
  double start = space.home_travel;
  for (int k = 0; !level(start) && k <= fineness.travel_pieces; ++k) {
    // Home is tilted: look around it.
    start = space.home_travel + (k % 2 == 0 ? 1.0 : -1.0) * 0.5 * (k + 1) * step;
  }
  if (!level(start)) return std::nullopt;
  return TravelRange{walk(start, space.low, -step, fineness.halvings, level),
                     walk(start, space.high, step, fineness.halvings, level)};
}

double tilt_reached(const PlatformSpace& space, const Fineness& fineness, double direction,
                    double travel) {
  return walk(0.0, space.max_tilt, space.max_tilt / fineness.tilt_pieces, fineness.halvings,
              [&](double tilt) {
                return space.reachable(tilt * std::cos(direction), tilt * std::sin(direction),
                                       travel);
              });
}

}  // namespace

WorkspaceSummary summarise_platform_workspace(const PlatformSpace& space) {
  WorkspaceSummary summary;
  const std::optional<TravelRange> travel = travel_interval(space, kForNumbers);
  if (!travel) return summary;
  summary.min_travel = travel->min;
  summary.max_travel = travel->max;
  summary.mid_travel = 0.5 * (summary.min_travel + summary.max_travel);
  summary.min_tilt_at_mid_travel = space.max_tilt;
  for (int direction = 0; direction < 720; ++direction) {
    summary.min_tilt_at_mid_travel =
        std::min(summary.min_tilt_at_mid_travel,
                 tilt_reached(space, kForNumbers, kRound * direction / 720.0, summary.mid_travel));
  }
  for (int layer = 0; layer <= 40 && summary.max_tilt < space.max_tilt; ++layer) {
    const double at = summary.min_travel + (summary.max_travel - summary.min_travel) * layer / 40.0;
    for (int direction = 0; direction < 72; ++direction) {
      summary.max_tilt = std::max(summary.max_tilt,
                                  tilt_reached(space, kForNumbers, kRound * direction / 72.0, at));
    }
  }
  return summary;
}

WorkspaceOutline outline_platform_workspace(const PlatformSpace& space) {
  WorkspaceOutline outline;
  outline.pitch_axis = space.axes.pitch;
  outline.roll_axis = space.axes.roll;
  outline.travel_axis = space.axes.travel;
  const std::optional<TravelRange> travel = travel_interval(space, kForDrawing);
  if (!travel) return outline;
  for (int layer = 0; layer < kLayers; ++layer) {
    const double part = static_cast<double>(layer) / (kLayers - 1);
    WorkspaceOutline::TiltLayer tilts{(1.0 - part) * travel->min + part * travel->max, {}};
    for (int direction = 0; direction < kDirections; ++direction) {
      tilts.tilts.push_back(
          tilt_reached(space, kForDrawing, kRound * direction / kDirections, tilts.travel));
    }
    outline.tilt_layers.push_back(std::move(tilts));
  }
  return outline;
}

}  // namespace softfinger
