#pragma once

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/finger/finger_potential.hpp"

namespace softfinger {

/// A contact set with one entry per skin sample, nothing touching.
[[nodiscard]] ContactSet make_contact_set(const FingerModel& model);

/// Fills `set` from the potential's current point (settled), expressed in F. Allocates nothing.
void report_contact(const FingerModel& model, const FingerPotential& potential, ContactSet& set);

}  // namespace softfinger
