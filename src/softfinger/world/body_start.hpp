#pragma once

#include <span>
#include <vector>

#include "softfinger/world/body_motion.hpp"

namespace softfinger {

/// How bodies move at the start, where they stand at `places`: as the scene says, as far as their
/// joints allow it, and with what they hang on.
[[nodiscard]] std::vector<BodyMotion> motions_at_start(const BodyTree& tree,
                                                       std::span<const VirtualObject> objects,
                                                       std::span<const BodyPlace> places);

}  // namespace softfinger
