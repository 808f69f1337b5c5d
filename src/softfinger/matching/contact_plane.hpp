#pragma once

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/device/device.hpp"

namespace softfinger {

/// The simplest rendering there is, as a baseline: the surface through the force-weighted centroid
/// of the contact, facing along its mean normal, brought into the workspace. `from`, which is
/// reachable, is returned for a device that neither turns nor travels.
[[nodiscard]] Configuration contact_plane(const Device& device, const ContactSet& contact,
                                          const Configuration& from);

}  // namespace softfinger
