#include "softfinger/objectives/contact_plane.hpp"

#include <cmath>
#include <utility>

#include "softfinger/matching/limit_clamp.hpp"

namespace softfinger {

ContactPlaneObjective::ContactPlaneObjective(const std::shared_ptr<const FingerModel>& model,
                                             std::shared_ptr<const Device> device)
    : device_(std::move(device)), surface_(device_, static_cast<int>(model->sample_nodes.size())) {}

const RenderedSurface& ContactPlaneObjective::tick(const VirtualFinger& finger, double elapsed) {
  rendered_ = surface_.tick(finger.contact, elapsed);
  if (finger.contact.contact_count > 0 && device_->approach_axis() >= 0) {
    rendered_.configuration = plane(finger.contact);
    static_cast<void>(device_->inverse_kinematics(rendered_.configuration, rendered_.joints));
  }
  return rendered_;
}

Configuration ContactPlaneObjective::plane(const ContactSet& contact) const {
  Configuration q = device_->facing(contact.mean_normal_F, device_->home());
  // Along its own normal the surface comes nearer as much as it travels along that normal.
  for (int round = 0; round < 20; ++round) {
    const Pose X_FP = device_->surface_pose(q);
    const double height = (X_FP.rotation.transpose() * (contact.centroid_F - X_FP.translation)).z();
    if (std::abs(height) < 1e-9) break;
    q[device_->approach_axis()] += height;
  }
  return device_->reachable(q) ? q : clamped_to_limits(*device_, q);
}

}  // namespace softfinger
