#include "softfinger/objectives/first_touch_match.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "softfinger/base/error.hpp"
#include "softfinger/matching/contact_plane.hpp"
#include "softfinger/matching/levenberg_marquardt.hpp"
#include "softfinger/matching/packed_samples.hpp"

namespace softfinger {
namespace {

/// What the paper has is no choice.
void check_published(const MatchingOptions& options) {
  if (options.limits == MatchingLimits::kInside) {
    throw InputError(
        "match: --limits inside: \"published\" cuts to limits afterwards; clamp, or none");
  }
  if (options.separation == Separation::kScene) {
    throw InputError("match: --separation scene: \"published\" has one for all; constant");
  }
}

MatchingResult as_published(const Device& device, const ContactPoints& points,
                            const MatchingOptions& options, ContactSurfaceMatching& matching) {
  check_published(options);
  PackedSamples packed(static_cast<int>(points.points_F.size()));
  const LevenbergMarquardt::Outcome found = LevenbergMarquardt(device).minimise(
      packed.pack(points, options, device.settings().matching.separation_tolerance), device.home());
  MatchingResult result = matching.answer(points, options, found.q);
  result.iterations = found.iterations;
  result.termination = found.termination;
  return result;
}

MatchingResult on_fitted_plane(const Device& device, const ContactPoints& points,
                               const MatchingOptions& options, ContactSurfaceMatching& matching) {
  MatchingOptions within = options;  // there is nothing to optimise
  if (within.limits == MatchingLimits::kInside) within.limits = MatchingLimits::kClamp;
  const FittedPlane plane = contact_plane(points, options.weights, device);
  return matching.answer(points, within,
                         std::ranges::count(points.in_contact, 0) == std::ssize(points.in_contact)
                             ? device.home()
                             : on_plane(device, plane));
}

}  // namespace

MatchingResult first_touch_match(const ObjectiveKind& objective,
                                 const std::shared_ptr<const Device>& device,
                                 const ContactPoints& points, const MatchingOptions& options,
                                 ContactSurfaceMatching& matching) {
  if (const std::string why = why_not(objective, *device); !why.empty()) throw InputError(why);
  if (objective.name == "surface") return matching.solve(points, options);
  if (objective.name == "published") return as_published(*device, points, options, matching);
  if (objective.name == "plane") return on_fitted_plane(*device, points, options, matching);
  throw InputError(
      fmt::format("objective {}: follows what was before; a match takes surface, published or "
                  "plane",
                  objective.name));
}

}  // namespace softfinger
