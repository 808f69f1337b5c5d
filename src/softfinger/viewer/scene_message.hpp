#pragma once

#include <string>

#include "softfinger/session/live_feed.hpp"

namespace softfinger {

/// A scene as the page reads it, one JSON text per generation. Lengths in mm, points as flat arrays
/// [x, y, z, x, ...], triangles as flat arrays of indices. Keys are those of page/src/wire.ts.
[[nodiscard]] std::string scene_message(const SceneDescription& scene);

}  // namespace softfinger
