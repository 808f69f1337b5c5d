#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace softfinger {

/// What the device's configuration is chosen for. The first ones are for use, the others baselines
/// that evaluations compare with.
enum class Objective {
  kSurface,          ///< contact surface matching
  kSurfaceAndForce,  ///< and the force that the twin feels
  kStress,           ///< the stress that the twin bears below its skin
  kPublished,        ///< as in Perez et al. 2015: constant separation, joints cut afterwards
  kContactPlane      ///< a plane at the contact's centroid and mean normal
};

struct ObjectiveName {
  Objective objective;
  std::string_view name;
};
inline constexpr std::array<ObjectiveName, 5> kObjectiveNames{{
    {Objective::kSurface, "surface"},
    {Objective::kSurfaceAndForce, "surface_and_force"},
    {Objective::kStress, "stress"},
    {Objective::kPublished, "published"},
    {Objective::kContactPlane, "contact_plane"},
}};

[[nodiscard]] constexpr std::optional<Objective> objective_of(std::string_view name) {
  for (const ObjectiveName& each : kObjectiveNames) {
    if (each.name == name) return each.objective;
  }
  return std::nullopt;
}

}  // namespace softfinger
