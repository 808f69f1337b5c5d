#include "softfinger/twin/force_limiter.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/base/units.hpp"
#include "softfinger/twin/force_ceiling.hpp"

namespace softfinger {
namespace {

/// Of the limit, for what happens between two ticks.
constexpr double kKept = 0.85;
constexpr double kFirstBack = 0.1 * mm;  // back
constexpr double kMostBack = 20.0 * mm;
constexpr int kBackRefinements = 5;

}  // namespace

ForceLimiter::ForceLimiter(const FingerModel& model, std::shared_ptr<const Device> device)
    : twin_(stiffest_wearer(model), std::move(device)) {}

bool ForceLimiter::needed(const Device& device) {
  if (!(device.settings().max_force > 0.0) || device.approach_axis() < 0) return false;
  for (int k = 0; k < device.degrees_of_freedom(); ++k) {
    if (k != device.approach_axis() && device.axes()[static_cast<std::size_t>(k)].unit != deg) {
      return true;
    }
  }
  return false;
}

double ForceLimiter::force_at(const Configuration& q) {
  twin_.attempt(q);
  return twin_.contact().normal_force;
}

Configuration ForceLimiter::limited(const Configuration& q, double friction_coefficient,
                                    double elapsed) {
  const Device& device = twin_.device();
  const double most = kKept * device.settings().max_force;
  follow(limited_);
  twin_.begin_frame(std::max(kMostFriction, friction_coefficient), elapsed);
  Configuration at = q;
  if (force_at(q) > most) {
    const auto back = [&](double distance) {
      Configuration drawn = q;
      device.advance(-distance, drawn);
      return drawn;
    };
    double hard = 0.0;
    double soft = kFirstBack;
    while (soft < kMostBack && force_at(back(soft)) > most) {
      hard = soft;
      soft *= 2.0;
    }
    for (int i = 0; i < kBackRefinements; ++i) {
      const double middle = 0.5 * (hard + soft);
      (force_at(back(middle)) > most ? hard : soft) = middle;
    }
    at = back(soft);
    twin_.attempt(at);
  }
  limited_ = at;
  under_way_ = true;
  return at;
}

void ForceLimiter::follow(const Configuration& went) {
  if (!under_way_) return;
  under_way_ = false;
  twin_.end_frame(went);
}

}  // namespace softfinger
