#pragma once

#include <memory>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/objectives/objective.hpp"

namespace softfinger {

/// "surface": contact surface matching, tick by tick.
class SurfaceObjective final : public Objective {
 public:
  SurfaceObjective(const std::shared_ptr<const FingerModel>& model,
                   std::shared_ptr<const Device> device);

  const RenderedSurface& tick(const VirtualFinger& finger, double elapsed) override;

 private:
  SurfaceFollowing surface_;
};

}  // namespace softfinger
