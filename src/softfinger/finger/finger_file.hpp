#pragma once

#include <filesystem>
#include <string>

#include "softfinger/files/config_file.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

// The keys of a finger file, docs/files.md. FingerModel::load() makes a finger of them.

/// `[mesh]`.
struct MeshKeys {
  std::filesystem::path file;
  double unit = 1.0;  ///< of its coordinates, m
};
[[nodiscard]] MeshKeys read_mesh_keys(const ConfigTable& table);

/// `[material]` and `[strain_limits]`, for the volumes of the solid's mesh.
void read_materials(const ConfigTable& table, SoftSolid& solid);
void read_strain_limits(const ConfigTable& table, StrainLimit& limits);

/// All other tables, for the volumes of the model's mesh. Returns `[size]`.
[[nodiscard]] FingerSize read_constants(const ConfigTable& root, FingerModel& model);

/// A JSON Schema of finger files, by what their reader asks for.
[[nodiscard]] std::string finger_schema();

}  // namespace softfinger
