#pragma once

#include <memory>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/objectives/objective.hpp"
#include "softfinger/objectives/twin_correction.hpp"

namespace softfinger {

/// "surface_and_force": the contact surface, put right so that the wearer feels the virtual
/// contact's normal force as well.
class SurfaceAndForceObjective final : public Objective {
 public:
  SurfaceAndForceObjective(const std::shared_ptr<const FingerModel>& model,
                           const std::shared_ptr<const Device>& device);

  const RenderedSurface& tick(const VirtualFinger& finger, double elapsed) override;
  void follow(const Configuration& went) override { correction_.follow(went); }

 private:
  SurfaceFollowing surface_;
  TwinCorrection correction_;
};

}  // namespace softfinger
