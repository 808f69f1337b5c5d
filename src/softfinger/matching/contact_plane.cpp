#include "softfinger/matching/contact_plane.hpp"

#include <cmath>

#include "softfinger/matching/limit_clamp.hpp"

namespace softfinger {

Configuration contact_plane(const Device& device, const ContactSet& contact,
                            const Configuration& from) {
  const int axis = device.approach_axis();
  if (contact.contact_count == 0 || axis < 0) return from;
  Configuration q = device.facing(contact.mean_normal_F, device.home());
  // Along its own normal the surface comes nearer as much as it travels along that normal.
  for (int round = 0; round < 20; ++round) {
    const Pose X_FP = device.surface_pose(q);
    const double height = (X_FP.rotation.transpose() * (contact.centroid_F - X_FP.translation)).z();
    if (std::abs(height) < 1e-9) break;
    q[axis] += height;
  }
  return device.reachable(q) ? q : clamped_to_limits(device, q);
}

}  // namespace softfinger
