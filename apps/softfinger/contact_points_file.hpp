#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "softfinger/geometry/pose.hpp"

/// Skin samples to match, as a points file gives them. SI; lengths agree.
struct ContactPointsFile {
  std::vector<softfinger::Vector3> points_F;
  std::vector<std::uint8_t> in_contact;
  std::vector<double> areas;  ///< empty where the file has none
  std::vector<double> gaps;   ///< empty where the file has none
  std::optional<double> separation_tolerance;
};

/// Reads `{"points_mm", "in_contact", "area_mm2", "distance_mm", "separation_tolerance_mm"}`
/// (JSON). Throws InputError with file and key.
[[nodiscard]] ContactPointsFile read_contact_points(const std::filesystem::path& file);
