#pragma once

#include <memory>
#include <vector>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/objectives/objective.hpp"
#include "softfinger/objectives/twin_correction.hpp"

namespace softfinger {

/// "stress": below the wearer's skin the virtual finger's stress, for which the contact surface is
/// where the search begins.
class StressObjective final : public Objective {
 public:
  StressObjective(const std::shared_ptr<const FingerModel>& model,
                  const std::shared_ptr<const Device>& device);

  const RenderedSurface& tick(const VirtualFinger& finger, double elapsed) override;
  void follow(const Configuration& went) override { correction_.follow(went); }

 private:
  SurfaceFollowing surface_;
  TwinCorrection correction_;
  std::vector<Vector3> nodes_F_;
};

}  // namespace softfinger
