#pragma once

#include <string>
#include <vector>

#include "softfinger/device/mechanism/linkage.hpp"
#include "softfinger/device/surface_piece.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {

// The tables of a mechanism's file that describe its bodies.

/// A joint as the file has it.
struct NamedJoint {
  ConfigTable table;
  std::string name;
  JointType type = JointType::kFixed;
  int body = 0;  ///< that it carries
  bool actuated = false;
  double min = 0.0, max = 0.0;  ///< of an actuated one, rad or m
};

/// `[[body]]`, `[[joint]]` and `[[loop]]`.
struct LinkageTables {
  std::vector<std::string> bodies;  ///< names in the linkage's order; 0 is "base"
  std::vector<NamedJoint> joints;   ///< in the file's order
  std::vector<ConfigTable> loops;
  Linkage linkage;
  LinkageCoordinates guess;
};
[[nodiscard]] LinkageTables read_linkage(const ConfigTable& root);

/// `[[surface]]`: what touches the finger. Without `load_meshes` the files of meshes are not
/// opened.
[[nodiscard]] std::vector<SurfacePiece> read_surface(const ConfigTable& root,
                                                     const std::vector<std::string>& bodies,
                                                     bool load_meshes);

/// Index of the name that `key` has in `names`; refused, with the nearest, where there is none.
/// `what`: "body", "joint".
[[nodiscard]] int read_name(const ConfigTable& table, const std::string& key,
                            const std::vector<std::string>& names, const std::string& what);
/// A pose of keys that end in `suffix`: origin_mm and rotation_vector_deg, or origin_a_mm and
/// rotation_vector_a_deg.
[[nodiscard]] Pose read_frame(const ConfigTable& table, const std::string& suffix = {});

}  // namespace softfinger
