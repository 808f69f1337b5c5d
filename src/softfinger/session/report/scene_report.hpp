#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "softfinger/geometry/mesh_shape.hpp"

namespace softfinger {

/// The fields of `scene check --json`: what is in a scene, after all that a run would load was
/// loaded. Throws InputError with file, line and key.
nlohmann::ordered_json scene_report(const std::filesystem::path& scene,
                                    const LoadObserver& observer = {});

}  // namespace softfinger
