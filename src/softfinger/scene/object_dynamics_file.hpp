#pragma once

#include <optional>
#include <string>
#include <vector>

#include "softfinger/contact/virtual_object.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {

/// What `motion = "dynamic"` brings with it, as read before all objects and their meshes are known.
struct ReadDynamics {
  ConfigTable table;  ///< of the object
  ObjectDynamics dynamics;
  std::optional<double> density;      ///< kg/m^3, instead of the mass
  std::optional<ConfigTable> joint;   ///< its table
  std::optional<std::string> parent;  ///< by name
};

/// More move in no scene.
inline constexpr int kMostMovingObjects = 64;

/// Reads `motion` and what depends on it; empty: the object follows its script. Throws InputError.
[[nodiscard]] std::optional<ReadDynamics> read_dynamics(const ConfigTable& object, bool is_plane);

/// Puts them in their objects, which have their shapes: mass by density, parents by name. Throws
/// InputError where a shape has no volume, a parent is unknown or joints make a loop.
void finish_dynamics(const std::vector<std::pair<std::size_t, ReadDynamics>>& read,
                     std::vector<VirtualObject>& objects);

}  // namespace softfinger
