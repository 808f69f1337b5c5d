#include "softfinger/objectives/objective_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "softfinger/device/device_objectives.hpp"
#include "softfinger/matching/contact_plane.hpp"
#include "softfinger/objectives/plane.hpp"
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
    ObjectiveKind{"surface", "contact surface", make<SurfaceObjective>},
    ObjectiveKind{"surface_and_force", "contact surface and force", make<SurfaceAndForceObjective>},
    ObjectiveKind{"stress", "stress below the skin", make<StressObjective>},
    ObjectiveKind{"published", "contact surface as published", make<PublishedObjective>},
    ObjectiveKind{"plane", "plane at the contact's centroid", make<PlaneObjective>,
                  "a length in its configuration, to move the surface along", takes_plane},
};

/// Device files are read below this table.
static_assert(std::ranges::equal(kKinds, kDeviceObjectives, {}, &ObjectiveKind::name));

bool has(const Device& device, const ObjectiveKind& kind) {
  return kind.fits == nullptr || kind.fits(device);
}

}  // namespace

std::span<const ObjectiveKind> objective_kinds() { return kKinds; }

const ObjectiveKind* objective_kind(std::string_view name) {
  const auto* const found =
      std::ranges::find(kKinds, present_objective(name), &ObjectiveKind::name);
  return found == kKinds.end() ? nullptr : found;
}

const ObjectiveKind& objective_kind(const Device& device) {
  return *objective_kind(device.settings().matching.objective);
}

double number_of(const ObjectiveKind& kind) {
  const auto* const found = std::ranges::find(kKinds, kind.name, &ObjectiveKind::name);
  return found == kKinds.end() ? std::numeric_limits<double>::quiet_NaN()
                               : static_cast<double>(found - kKinds.begin());
}

const ObjectiveKind* objective_numbered(double number) {
  if (!(number >= 0.0 && number < static_cast<double>(kKinds.size()))) return nullptr;
  const auto place = static_cast<std::size_t>(number);
  return static_cast<double>(place) == number ? &kKinds[place] : nullptr;
}

std::string why_not(const ObjectiveKind& kind, const Device& device) {
  if (has(device, kind)) return {};
  std::vector<std::string_view> others;
  for (const ObjectiveKind& other : kKinds) {
    if (has(device, other)) others.push_back(other.name);
  }
  return fmt::format("\"{}\" needs {}, and this device has none; it can have {}", kind.name,
                     kind.needs, fmt::join(others, ", "));
}

}  // namespace softfinger
