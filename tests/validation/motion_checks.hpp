#pragma once

#include <vector>

namespace softfinger::validation {

/// What is held between two finger pads, and for how long: of the hold below and of its rivals.
struct HeldCapsule {
  double radius = 12e-3;       ///< m
  double half_length = 25e-3;  ///< m, with its ends
  double mass = 45e-3;         ///< kg
  double friction = 0.8;
  double duration = 60.0;  ///< s, after it has settled
};
/// How far it is from where it was when it had settled, m, once a second.
struct Drift {
  double force = 0.0;  ///< N, of each finger
  std::vector<double> drift;
};

/// An upright capsule lifted by two fingers, then kept; shaken: 5 mm up and down twice a second
/// meanwhile, and looked at where the fingers are.
[[nodiscard]] Drift held_capsule(const HeldCapsule& capsule, bool shaken);

/// A block on a slope.
struct Incline {
  double friction = 0.4;
  double angle_error = 0.0;         ///< rad, of the slope at which it begins to slide
  double acceleration_error = 0.0;  ///< relative, two degrees beyond that
  double creep = 0.0;               ///< m/s, half a degree below
};
[[nodiscard]] Incline incline();

struct MotionFigures {
  double hold_margin = 0.0;       ///< 2 mu N over the weight of the heaviest that is held
  double momentum_error = 0.0;    ///< relative, in a collision
  double pendulum_lost = 0.0;     ///< of the amplitude, a second
  double energy_gained = 0.0;     ///< J, the most in a step of a closed system
  double energy_lost = 0.0;       ///< J, in all: or nothing has met
  double rest_penetration = 0.0;  ///< m, the most of 1 g to 2 kg
  double button_force = 0.0;      ///< N, the most that a finger at 1 mm/s feels before the snap
  double button_travel = 0.0;     ///< m, where it does
  double stiff_soft_force = 0.0;  ///< relative, of a soft object of 100 MPa against a rigid one
  int unconverged = 0;            ///< steps, of all of these
  long steps = 0;
};
[[nodiscard]] MotionFigures motion_figures();

}  // namespace softfinger::validation
