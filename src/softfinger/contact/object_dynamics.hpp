#pragma once

#include <array>
#include <optional>
#include <vector>

#include "softfinger/base/name_table.hpp"
#include "softfinger/geometry/pose.hpp"

namespace softfinger {

enum class JointKind { kSlider, kHinge, kBall, kFixed };
inline constexpr std::array<NameRow<JointKind>, 4> kJointKinds{{
    {JointKind::kSlider, "slider"},
    {JointKind::kHinge, "hinge"},
    {JointKind::kBall, "ball"},
    {JointKind::kFixed, "fixed"},
}};

/// Force of a slider by how far it is pressed in: along its axis (N) at travel = -q (m). A monotone
/// cubic between the points; beyond them it goes on with its end slopes. Travel strictly increases.
struct JointCurve {
  std::vector<double> travel, force;
};

/// Rest positions of a hinge: a torque -torque sin(count q), N m.
struct JointDetents {
  int count = 0;
  double torque = 0.0;
};

/// How an object hangs on another or on the world. Its coordinate q, 0 at the start, is m along the
/// axis of a slider and rad about that of a hinge, counted on over full turns; ball and fixed have
/// none.
struct Joint {
  JointKind kind = JointKind::kFixed;
  int parent = -1;  ///< number of an object of the scene; -1: the world
  Vector3 axis_O = Vector3::UnitZ();
  Vector3 point_O = Vector3::Zero();            ///< of hinge and ball, m
  std::optional<std::array<double, 2>> limits;  ///< of q: least, greatest
  double spring = 0.0;                          ///< towards rest, N/m or N m/rad
  double rest = 0.0;                            ///< q there
  double damping = 0.0;                         ///< N s/m or N m s/rad
  double friction = 0.0;                        ///< dry, N or N m
  std::optional<JointCurve> curve;
  std::optional<JointDetents> detents;
};

/// Where a part of a hand is that nobody has seen, in W, m.
inline const Vector3 kNowhere(0.0, 0.0, -1000.0);

/// What pulls a part of a hand towards where it is tracked: springs and dampers in translation and
/// rotation that together pull no harder than their limits.
struct Following {
  int hand = 0;                     ///< number of the hand; parts of one do not touch each other
  double stiffness = 0.0;           ///< N/m
  double damping = 0.0;             ///< N s/m
  double rotation_stiffness = 0.0;  ///< N m/rad
  double rotation_damping = 0.0;    ///< N m s/rad
  double force_limit = 0.0;         ///< N
  double torque_limit = 0.0;        ///< N m
  double foundation = 0.0;          ///< of its flesh under contact, N/m^3
};

/// What a scene says of a rigid object that moves by the forces on it. Velocities are at the start,
/// in W, of the centre of mass; of those of a jointed object what its joint allows counts.
struct ObjectDynamics {
  double mass = 0.0;                             ///< kg
  Vector3 velocity_W = Vector3::Zero();          ///< m/s
  Vector3 angular_velocity_W = Vector3::Zero();  ///< rad/s
  std::optional<Joint> joint;                    ///< absent: free
  std::optional<Following> following = {};       ///< a part of a hand; it has no weight
};

}  // namespace softfinger
