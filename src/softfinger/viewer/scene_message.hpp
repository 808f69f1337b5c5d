#pragma once

#include <string>

#include "softfinger/session/live_feed.hpp"

namespace softfinger {

/// Of all that goes over the page's WebSocket, as docs/protocol.md has it: grows when a client that
/// knows the one before would misread what comes, or be refused. New keys and new requests need
/// none.
inline constexpr int kProtocolVersion = 2;

/// A scene as clients read it, one JSON text per generation. Lengths in mm, points as flat arrays
/// [x, y, z, x, ...], triangles as flat arrays of indices. Keys are those of docs/protocol.md.
[[nodiscard]] std::string scene_message(const SceneDescription& scene);

}  // namespace softfinger
