#pragma once

#include <memory>

#include "softfinger/matching/contact_surface_matching.hpp"
#include "softfinger/objectives/objective_kinds.hpp"

namespace softfinger {

/// The configuration that the running loop's objective of that kind gives at first touch: of
/// "surface", "plane" and "published" alone, for the others are led by what was before. `matching`
/// is one for this device and at least as many points. Throws InputError for another kind, where
/// the device cannot have it, and where "published" is given options that its paper does not have.
[[nodiscard]] MatchingResult first_touch_match(const ObjectiveKind& objective,
                                               const std::shared_ptr<const Device>& device,
                                               const ContactPoints& points,
                                               const MatchingOptions& options,
                                               ContactSurfaceMatching& matching);

}  // namespace softfinger
