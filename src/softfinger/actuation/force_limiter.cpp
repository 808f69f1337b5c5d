#include "softfinger/actuation/force_limiter.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/actuation/force_ceiling.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

/// Of the limit, for what happens between two ticks.
constexpr double kKept = 0.85;
constexpr double kEnough = 0.98;  // of what is kept: no need to seek on
constexpr double kFirstWay = 0.1 * mm;
constexpr double kMostBack = 20.0 * mm;
constexpr double kFineWay = 3e-3 * mm;
constexpr int kRefinements = 5;

}  // namespace

ForceLimiter::ForceLimiter(const FingerModel& model, std::shared_ptr<const Device> device)
    : twin_(stiffest_wearer(model), std::move(device)) {}

bool ForceLimiter::needed(const Device& device) {
  if (!(device.settings().max_force > 0.0) || device.approach_axis() < 0) return false;
  for (int k = 0; k < device.degrees_of_freedom(); ++k) {
    if (k != device.approach_axis() && !device.axes()[static_cast<std::size_t>(k)].angular) {
      return true;
    }
  }
  return false;
}

Configuration ForceLimiter::drawn_back(const Configuration& q, double way) const {
  Configuration drawn = q;
  if (way > 0.0) twin_.device().advance(-way, drawn);
  return drawn;
}

ForceLimiter::Tried ForceLimiter::try_back(const Configuration& q, double way) {
  twin_.attempt(drawn_back(q, way));
  return {way, twin_.contact().normal_force};
}

/// The least way back from q at which no more than `most` presses. Sought from the last one: what
/// is asked for may be millimetres too deep, and to press that takes long.
double ForceLimiter::way_back(const Configuration& q, double most) {
  Tried soft = try_back(q, back_);
  Tried hard = soft;
  for (double step = kFirstWay; soft.force > most && soft.way < kMostBack; step *= 2.0) {
    hard = soft;
    soft = try_back(q, soft.way + step);
  }
  for (double step = kFirstWay; hard.force <= most && soft.way > 0.0 && soft.force < kEnough * most;
       step *= 2.0) {
    hard = try_back(q, std::max(0.0, soft.way - step));
    if (hard.force <= most) soft = hard;
  }
  for (int k = 0; k < kRefinements && hard.force > most && soft.force < kEnough * most &&
                  soft.way - hard.way > kFineWay;
       ++k) {
    // Force bends upwards, so that a chord's end is soft; every other time the middle.
    const double part =
        k % 2 == 1 ? 0.5 : std::clamp((most - soft.force) / (hard.force - soft.force), 0.1, 0.9);
    const Tried tried = try_back(q, soft.way - part * (soft.way - hard.way));
    (tried.force > most ? hard : soft) = tried;
  }
  return soft.way;
}

Configuration ForceLimiter::limited(const Configuration& q, double friction_coefficient,
                                    double elapsed) {
  follow(limited_);
  twin_.begin_frame(std::max(kMostFriction, friction_coefficient), elapsed);
  back_ = way_back(q, kKept * twin_.device().settings().max_force);
  limited_ = drawn_back(q, back_);
  if (twin_.configuration() != limited_) twin_.attempt(limited_);
  under_way_ = true;
  return limited_;
}

void ForceLimiter::follow(const Configuration& went) {
  if (!under_way_) return;
  under_way_ = false;
  twin_.end_frame(went);
}

}  // namespace softfinger
