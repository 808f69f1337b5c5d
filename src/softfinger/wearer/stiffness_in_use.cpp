#include "softfinger/wearer/stiffness_in_use.hpp"

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

/// Of the force of a finger pad by depth, 1/m: exp(m d) with m = 2.1 /mm (Pawluk and Howe 1999).
constexpr double kForceGrowth = 2.1 / mm;

}  // namespace

double stress_of_growing_force(const Relaxation& relaxation, double rate) {
  double left = 1.0;
  for (const Relaxation::Term& term : relaxation.terms) {
    left -= term.fraction / (1.0 + rate * term.time);
  }
  return left;
}

double stiffness_in_use(const FingerModel& finger, double speed) {
  return 1.0 / stress_of_growing_force(finger.relaxation, kForceGrowth * speed);
}

}  // namespace softfinger
