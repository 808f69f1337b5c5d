#include "softfinger/objectives/twin_correction.hpp"

#include <algorithm>

#include "softfinger/matching/limit_clamp.hpp"

namespace softfinger {

TwinCorrection::TwinCorrection(const std::shared_ptr<const FingerModel>& model,
                               std::shared_ptr<const Device> device, MatchingOptions matching,
                               ForceAwareOptions options)
    : device_(std::move(device)),
      matching_(matching),
      force_(model, device_, static_cast<int>(model->sample_nodes.size()), options),
      skin_(*device_, static_cast<int>(model->sample_nodes.size())) {
  reset();
}

void TwinCorrection::reset() {
  force_.reset();
  correction_ = Configuration::Zero(device_->degrees_of_freedom());
  rendered_ = {};
  rendered_.configuration = device_->home();
}

const RenderedSurface& TwinCorrection::tick(const ContactSet& contact,
                                            std::span<const Vector3> nodes_F,
                                            const RenderedSurface& surface, double elapsed) {
  const ForceAwareResult& matched = force_.match(
      contact, surface.configuration, contact.friction_coefficient, elapsed, matching_, nodes_F);
  const EasingRates& rates = device_->settings().matching.easing;
  // As near the match as is possible from where it was and from where the surface takes it: a
  // surface that jumps between two answers as good takes nobody along who stays.
  for (int k = 0; k < correction_.size(); ++k) {
    const bool angle = device_->axes()[static_cast<std::size_t>(k)].angular;
    const double room = (angle ? rates.turn_by_force : rates.move_by_force) * elapsed;
    const double stay = rendered_.configuration[k];
    const double go = surface.configuration[k] + correction_[k];
    correction_[k] =
        std::clamp(matched.configuration[k], std::min(stay, go) - room, std::max(stay, go) + room) -
        surface.configuration[k];
  }
  rendered_ = surface;
  Configuration wanted = surface.configuration + correction_;
  if (contact.contact_count == 0 && !correction_.isZero()) {
    skin_.take(contact);
    wanted = skin_.with_gap(wanted, skin_.gap(surface.configuration));
    if (!device_->advances()) wanted = surface.configuration;
  }
  rendered_.configuration =
      device_->reachable(wanted) ? wanted : last_reachable(*device_, surface.configuration, wanted);
  static_cast<void>(device_->inverse_kinematics(rendered_.configuration, rendered_.joints));
  if (contact.contact_count > 0) {
    rendered_.deviation = rendered_.configuration == matched.configuration
                              ? matched.deviation
                              : force_.deviation(rendered_.configuration);
    rendered_.iterations += matched.iterations;
  }
  return rendered_;
}

}  // namespace softfinger
