#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>

#include "softfinger/actuation/travel_ceiling.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// force_ceiling(), which takes seconds: made once for a finger, a device, a limit, a build and an
/// instruction set, and kept among the user's caches. What is there is used only where all of this
/// is the same, the user alone may write to it, and nothing of it is damaged; else it is made anew.
/// Throws what force_ceiling() throws.
[[nodiscard]] TravelCeiling kept_force_ceiling(const FingerModel& model,
                                               const std::shared_ptr<const Device>& device,
                                               double max_force, const std::stop_token& stop = {});

/// Where it is kept; empty: nowhere, since there is no folder for caches, or the device has a mesh
/// for its surface, whose file may change.
[[nodiscard]] std::filesystem::path kept_ceiling_file(const FingerModel& model,
                                                      const Device& device, double max_force);

/// What a file holds of a ceiling for this finger, device and limit; empty where that is nothing,
/// or not all.
[[nodiscard]] std::optional<TravelCeiling> read_kept_ceiling(
    const std::filesystem::path& file, const FingerModel& model,
    const std::shared_ptr<const Device>& device, double max_force);

}  // namespace softfinger
