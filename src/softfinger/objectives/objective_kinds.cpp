#include "softfinger/objectives/objective_kinds.hpp"

#include <algorithm>
#include <array>

#include "softfinger/device/device_objectives.hpp"
#include "softfinger/objectives/contact_plane.hpp"
#include "softfinger/objectives/published.hpp"
#include "softfinger/objectives/stress.hpp"
#include "softfinger/objectives/surface.hpp"
#include "softfinger/objectives/surface_and_force.hpp"

namespace softfinger {
namespace {

template <typename Kind>
std::unique_ptr<Objective> make(const std::shared_ptr<const FingerModel>& model,
                                const std::shared_ptr<const Device>& device) {
  return std::make_unique<Kind>(model, device);
}

constexpr std::array kKinds{
    ObjectiveKind{"surface", "contact surface", true, make<SurfaceObjective>},
    ObjectiveKind{"surface_and_force", "contact surface and force", true,
                  make<SurfaceAndForceObjective>},
    ObjectiveKind{"stress", "stress below the skin", true, make<StressObjective>},
    ObjectiveKind{"published", "Perez et al. 2015", false, make<PublishedObjective>},
    ObjectiveKind{"contact_plane", "a plane at the contact's centroid", false,
                  make<ContactPlaneObjective>},
};

/// Device files are read below this table.
constexpr bool device_files_know_the_table() {
  const auto named = [](std::string_view name) {
    return std::find(kDeviceObjectives.begin(), kDeviceObjectives.end(), name) !=
           kDeviceObjectives.end();
  };
  std::size_t count = 0;
  for (const ObjectiveKind& kind : kKinds) {
    if (kind.for_devices != named(kind.name)) return false;
    count += kind.for_devices ? 1 : 0;
  }
  return count == kDeviceObjectives.size();
}
static_assert(device_files_know_the_table());

}  // namespace

std::span<const ObjectiveKind> objective_kinds() { return kKinds; }

const ObjectiveKind* objective_kind(std::string_view name) {
  const auto* const found = std::find_if(
      kKinds.begin(), kKinds.end(), [&](const ObjectiveKind& kind) { return kind.name == name; });
  return found == kKinds.end() ? nullptr : found;
}

const ObjectiveKind& objective_kind(const Device& device) {
  return *objective_kind(device.settings().matching.objective);
}

}  // namespace softfinger
