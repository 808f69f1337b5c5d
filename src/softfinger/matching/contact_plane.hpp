#pragma once

#include <span>

#include "softfinger/device/device.hpp"
#include "softfinger/matching/contact_surface_matching.hpp"

namespace softfinger {

/// The plane fitted to a contact, in F.
struct FittedPlane {
  Vector3 point = Vector3::Zero();   ///< m
  Vector3 normal = Vector3::Zero();  ///< unit, towards the finger; zero: not known
};

/// The plane of least squares through the points in contact, weighted as `weights` say, where no
/// forces are known; its normal is not where these leave it open, as on a line. It looks to the
/// side on which home of `device` has the finger.
[[nodiscard]] FittedPlane contact_plane(const ContactPoints& points, MatchingWeights weights,
                                        const Device& device);

/// Whether the device has what on_plane() moves: pins, or a length in its configuration.
[[nodiscard]] bool takes_plane(const Device& device);

/// The surface on a plane: from home it faces along the normal as far as it turns, then its lengths
/// are moved, the least way, until it meets the point. Pins are as high as the plane is over them,
/// within their stroke. Other limits are not looked at. Does not allocate.
[[nodiscard]] Configuration on_plane(const Device& device, const FittedPlane& plane);

}  // namespace softfinger
