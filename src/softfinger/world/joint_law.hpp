#pragma once

#include <array>
#include <optional>
#include <span>

#include "softfinger/contact/object_dynamics.hpp"
#include "softfinger/world/force_curve.hpp"

namespace softfinger {

/// A potential of a joint's coordinate q (m of a slider, rad of a hinge).
struct LawValue {
  double energy = 0.0;     ///< E, J
  double force = 0.0;      ///< dE/dq, N or N m: it pulls q the other way
  double stiffness = 0.0;  ///< d2E/dq2, N/m or N m/rad
};

/// What a slider or hinge does by its coordinate alone, all twice continuously differentiable but
/// dry friction: spring about rest, force curve, detents, and limits that are met within kOnset and
/// hold from there with a stiffness of the caller's choice. Viscous damping is the step's.
class JointLaw {
 public:
  /// limit_stiffness > 0, N/m or N m/rad.
  JointLaw(const Joint& joint, double limit_stiffness);

  [[nodiscard]] LawValue evaluate(double q) const;
  /// What the limits do of its force, N or N m.
  [[nodiscard]] double limit_force(double q) const;
  /// The least stiffness that the law has where limits let it come. A step of time_step h is convex
  /// in q if the inertia about q is more than -h^2 times it.
  [[nodiscard]] double least_stiffness() const;

  /// Dry friction of a joint that holds on at `anchor`: linear up to its limit, which it reaches
  /// kStick from there, and constant beyond (as ContactPotential's, with a limit that is known).
  [[nodiscard]] LawValue friction(double q, double anchor) const;
  /// Where a joint that came to q holds on from then.
  [[nodiscard]] double anchor_after(double q, double anchor) const;

  /// Snaps of its curve, by travel = -q.
  [[nodiscard]] std::span<const ForceCurve::Snap> snaps() const;
  /// Number of the rest position nearest to q, counted on over full turns; 0 without detents.
  [[nodiscard]] long detent(double q) const;
  /// How far q is beyond its limits, at most 0 within them; minus infinity without limits.
  [[nodiscard]] double beyond_limits(double q) const;

  /// Way until a limit holds with all its stiffness, and until friction gives way: m, and rad for
  /// a hinge (1 um at 10 mm).
  static constexpr double kOnset = 1e-6, kHingeOnset = 1e-4;
  static constexpr double kStick = 1e-6, kHingeStick = 1e-4;

 private:
  [[nodiscard]] LawValue limits(double q) const;
  [[nodiscard]] LawValue detents(double q) const;
  [[nodiscard]] double least_of_detents(double from, double to) const;

  std::optional<std::array<double, 2>> limits_;
  double limit_stiffness_, onset_, stick_;
  double spring_, rest_, friction_limit_;
  std::optional<ForceCurve> curve_;
  JointDetents detents_;
};

}  // namespace softfinger
