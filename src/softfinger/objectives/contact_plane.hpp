#pragma once

#include <memory>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/objectives/objective.hpp"

namespace softfinger {

/// "contact_plane", the simplest rendering there is, as a baseline: in contact the surface through
/// the force-weighted centroid of the contact, facing along its mean normal, brought into the
/// workspace. Off the skin, and of a device that neither turns nor travels, as "surface".
class ContactPlaneObjective final : public Objective {
 public:
  ContactPlaneObjective(const std::shared_ptr<const FingerModel>& model,
                        std::shared_ptr<const Device> device);

  /// E and iterations are the contact surface's.
  const RenderedSurface& tick(const VirtualFinger& finger, double elapsed) override;

 private:
  [[nodiscard]] Configuration plane(const ContactSet& contact) const;

  std::shared_ptr<const Device> device_;
  SurfaceFollowing surface_;
  RenderedSurface rendered_;
};

}  // namespace softfinger
