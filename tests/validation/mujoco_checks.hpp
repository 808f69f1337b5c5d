#pragma once

#include <string>

#include "motion_checks.hpp"

namespace softfinger::validation {

/// The same by MuJoCo with elliptic cones and else its defaults; with what its documentation
/// recommends against slip: friction a hundred times as stiff (impratio), or 20 noslip passes.
enum class MujocoContact { kUsual, kStiffFriction, kNoslip };
/// Its version, e.g. "2.2.2".
[[nodiscard]] std::string mujoco_version();
/// Between two rigid balls that press with `force` (N) each.
[[nodiscard]] Drift mujoco_held_capsule(const HeldCapsule& capsule, double force,
                                        MujocoContact contact);
[[nodiscard]] Incline mujoco_incline(MujocoContact contact);

}  // namespace softfinger::validation
