#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "softfinger/identification/press_curve.hpp"

namespace softfinger {

/// A complete finger file (TOML): every key of the file `model` was read from, defaults filled in,
/// with these constants in their place. Paths are made relative to `new_file`. `head` are comment
/// lines at the top; `remarks` are comments behind keys, by table and key ("strain_limits.min").
[[nodiscard]] std::string finger_file_text(const FingerModel& model,
                                           const FingerConstants& constants,
                                           const std::filesystem::path& new_file,
                                           const std::vector<std::string>& head,
                                           const std::map<std::string, std::string>& remarks);

/// Young's moduli by the key they stand under, Pa: "material.youngs_modulus_kPa" first where there
/// is one for all volumes, then those of layers with their own
/// ("material.NAME.youngs_modulus_kPa").
[[nodiscard]] std::vector<std::pair<std::string, double>> youngs_moduli(const FingerModel& model);

}  // namespace softfinger
