#pragma once

#include <string>
#include <vector>

#include "softfinger/device/mechanism/linkage.hpp"
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

}  // namespace softfinger
