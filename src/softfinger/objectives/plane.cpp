#include "softfinger/objectives/plane.hpp"

#include <utility>

#include "softfinger/matching/contact_plane.hpp"
#include "softfinger/matching/limit_clamp.hpp"

namespace softfinger {

PlaneObjective::PlaneObjective(const std::shared_ptr<const FingerModel>& model,
                               std::shared_ptr<const Device> device)
    : device_(std::move(device)),
      surface_(device_, static_cast<int>(model->sample_nodes.size())),
      points_(static_cast<int>(model->sample_nodes.size())),
      packed_(static_cast<int>(model->sample_nodes.size() + ContactSet::kMostFeatures)) {}

const RenderedSurface& PlaneObjective::tick(const VirtualFinger& finger, double elapsed) {
  const ContactSet& contact = finger.contact;
  rendered_ = surface_.tick(contact, elapsed);
  if (contact.contact_count == 0) return rendered_;
  rendered_.configuration =
      clamped_to_limits(*device_, on_plane(*device_, {contact.centroid_F, contact.mean_normal_F}));
  static_cast<void>(device_->inverse_kinematics(rendered_.configuration, rendered_.joints));
  rendered_.deviation = device_->deviation(
      rendered_.configuration, packed_.pack(points_.take(contact), MatchingOptions{},
                                            device_->settings().matching.separation_tolerance));
  rendered_.iterations = 0;
  rendered_.termination = Termination::kConverged;
  return rendered_;
}

}  // namespace softfinger
