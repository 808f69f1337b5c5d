#pragma once

#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// One finger with one device, objective and motion.
struct MatrixCase {
  std::string finger;               ///< stem of its file
  Vector3 scale = Vector3::Ones();  ///< of its length, breadth and depth
  std::string device;               ///< stem of its file
  std::string objective;
  /// Stem of a scene, or empty: a tap on a plane, tilted by `pitch_deg`, down in `tap_s`.
  std::string scene;
  double tap_s = 0.0;
  double pitch_deg = 0.0;
};

std::ostream& operator<<(std::ostream& out, const MatrixCase& one);

/// Every finger with every device, and drawn sizes with devices in turn; objectives, scenes and
/// taps of 0.1 to 1 s are dealt out evenly. The same for the same seed.
[[nodiscard]] std::vector<MatrixCase> matrix_cases(std::uint64_t seed);

/// Writes finger and scene into `folder`, which names the shipped files; returns the scene.
[[nodiscard]] std::filesystem::path write_scene(const MatrixCase& one,
                                                const std::filesystem::path& folder);

}  // namespace softfinger
