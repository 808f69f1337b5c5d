#pragma once

#include <cstdint>

#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// What became of a finger after it was mistreated.
struct Recovery {
  int trials = 0;
  int unconverged = 0;
  int not_finite = 0;
  long inverted = 0;     ///< elements left inside out, all trials together
  double apart = 0.0;    ///< greatest distance of a node from where it should be, m
  int iterations = 0;    ///< most of a trial
  double max_force = 0;  ///< N
  [[nodiscard]] bool sound() const;
};

/// Moves every free node of the resting finger, pressed on a plate, by up to 5 mm along each axis,
/// which leaves elements inside out all over, and lets it find its equilibrium: the one it has when
/// it starts from rest.
[[nodiscard]] Recovery scramble(const FingerModel& model, int trials, std::uint64_t seed);

/// Presses to 4 mm on a plate, a ball and an edge, and back.
[[nodiscard]] Recovery press_hard(const FingerModel& model);

}  // namespace softfinger
