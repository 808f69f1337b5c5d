#include "softfinger/device/workspace.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace softfinger {
namespace {

constexpr int kLayers = 13;     // of travel, for drawings
constexpr int kDirections = 48;  // of tilt, in a layer

/// Last point still inside on the way from `inside` to `outside`.
template <typename Predicate>
double boundary(double inside, double outside, Predicate&& reached) {
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (inside + outside);
    (reached(middle) ? inside : outside) = middle;
  }
  return inside;
}

/// Walks from `start`, which is inside, by `step` until it leaves or passes `end`.
template <typename Predicate>
double walk(double start, double end, double step, Predicate&& reached) {
  double at = start;
  while (step > 0.0 ? at < end : at > end) {
    const double next = step > 0.0 ? std::min(at + step, end) : std::max(at + step, end);
    if (!reached(next)) return boundary(at, next, reached);
    at = next;
  }
  return at;
}

}  // namespace

WorkspaceSummary summarise_platform_workspace(
    const std::function<bool(double pitch, double roll, double travel)>& reachable, double low,
    double high, double home_travel, double max_tilt) {
  WorkspaceSummary summary;
  const double step = (high - low) / 2000.0;
  const auto level = [&](double travel) { return reachable(0.0, 0.0, travel); };
  double start = home_travel;
  for (int k = 0; !level(start) && k <= 2000; ++k) {  // home is tilted: look around it
    start = home_travel + (k % 2 == 0 ? 1.0 : -1.0) * 0.5 * (k + 1) * step;
  }
  if (!level(start)) return summary;
  summary.min_travel = walk(start, low, -step, level);
  summary.max_travel = walk(start, high, step, level);
  summary.mid_travel = 0.5 * (summary.min_travel + summary.max_travel);

  const double tilt_step = max_tilt / 60.0;
  const auto tilt_reached = [&](double azimuth, double travel) {
    return walk(0.0, max_tilt, tilt_step, [&](double tilt) {
      return reachable(tilt * std::cos(azimuth), tilt * std::sin(azimuth), travel);
    });
  };
  constexpr double kRound = 2.0 * std::numbers::pi;
  summary.min_tilt_at_mid_travel = max_tilt;
  for (int direction = 0; direction < 720; ++direction) {
    summary.min_tilt_at_mid_travel =
        std::min(summary.min_tilt_at_mid_travel,
                 tilt_reached(kRound * direction / 720.0, summary.mid_travel));
  }
  for (int layer = 0; layer <= 40 && summary.max_tilt < max_tilt; ++layer) {
    const double travel =
        summary.min_travel + (summary.max_travel - summary.min_travel) * layer / 40.0;
    for (int direction = 0; direction < 72; ++direction) {
      summary.max_tilt =
          std::max(summary.max_tilt, tilt_reached(kRound * direction / 72.0, travel));
    }
  }
  for (int layer = 0; layer < kLayers; ++layer) {
    const double part = static_cast<double>(layer) / (kLayers - 1);
    WorkspaceSummary::TiltLayer tilts{
        (1.0 - part) * summary.min_travel + part * summary.max_travel, {}};
    for (int direction = 0; direction < kDirections; ++direction) {
      tilts.tilts.push_back(tilt_reached(kRound * direction / kDirections, tilts.travel));
    }
    summary.tilt_layers.push_back(std::move(tilts));
  }
  return summary;
}

}  // namespace softfinger
