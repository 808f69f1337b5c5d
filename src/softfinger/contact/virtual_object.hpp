#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "softfinger/contact/object_dynamics.hpp"
#include "softfinger/geometry/signed_distance.hpp"
#include "softfinger/geometry/trajectory.hpp"

namespace softfinger {

class SoftSolid;

/// A thing that can be touched. Its frame is O; the motion gives X_WO over time, or where it moves
/// by forces, at the start.
struct VirtualObject {
  std::string name;
  Shape shape;
  Trajectory motion;
  std::optional<double> friction_coefficient;   ///< the finger's where empty
  std::optional<ObjectDynamics> dynamics = {};  ///< absent: it follows its motion
  /// What it is of where it deforms, at rest in O; its shape is then without meaning. Nodes that
  /// are held follow the motion. Null: it is rigid.
  std::shared_ptr<const SoftSolid> soft = {};

  /// Whether it moves by the forces on it, as a whole or in part.
  [[nodiscard]] bool moves_by_forces() const { return dynamics.has_value() || soft != nullptr; }
  /// Whether a person can take it: it moves by forces as a whole, and is no part of a hand.
  [[nodiscard]] bool can_be_held() const { return dynamics && !dynamics->following; }
  /// Number of the hand that it is a part of; -1: none.
  [[nodiscard]] int hand() const {
    return dynamics && dynamics->following ? dynamics->following->hand : -1;
  }
};

/// Coefficient of friction between two objects: the larger of those given.
[[nodiscard]] inline double friction_between(const VirtualObject& a, const VirtualObject& b) {
  constexpr double kUsual = 0.5;
  if (!a.friction_coefficient && !b.friction_coefficient) return kUsual;
  return std::max(a.friction_coefficient.value_or(0.0), b.friction_coefficient.value_or(0.0));
}

}  // namespace softfinger
