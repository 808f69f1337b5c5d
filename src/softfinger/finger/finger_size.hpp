#pragma once

#include <optional>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

class ConfigTable;
class FingerModel;

/// Sizes of the skin's bounding box at rest along x, y and z of F, m; empty: the mesh's.
struct FingerSize {
  std::optional<double> length, breadth, depth;

  // What a person's file, flags and page may say.
  static constexpr double kLeast = 1e-3;    ///< m
  static constexpr double kGreatest = 0.5;  ///< m
};

/// The keys of a table [size], length_mm, breadth_mm and depth_mm, all optional. Throws InputError.
[[nodiscard]] FingerSize read_finger_size(const ConfigTable& table);

/// Those of a model; all three.
[[nodiscard]] FingerSize finger_size(const FingerModel& model);

/// By how much `to` is larger than `from` along x, y and z: by the boxes of their whole meshes,
/// since the skin of one may reach further round than the other's.
[[nodiscard]] Vector3 size_ratio(const FingerModel& from, const FingerModel& to);

/// Scales `model`'s nodes about F's origin along x, y and z; `model` has its samples.
void resize(FingerModel& model, const FingerSize& size);

}  // namespace softfinger
