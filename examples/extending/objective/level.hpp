#pragma once

#include <memory>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/objectives/objective_kinds.hpp"

namespace softfinger {

/// "level": as far advanced as the contact surface asks for, but never turned: what a device of one
/// degree of freedom would do, on one that has more. Tells what tilt is worth.
class LevelObjective final : public Objective {
 public:
  LevelObjective(const std::shared_ptr<const FingerModel>& model,
                 std::shared_ptr<const Device> device);

  const RenderedSurface& tick(const VirtualFinger& finger, double elapsed) override;

 private:
  std::shared_ptr<const Device> device_;
  SurfaceFollowing surface_;
  RenderedSurface rendered_;
};

/// Its row of the table in objectives/objective_kinds.cpp.
[[nodiscard]] const ObjectiveKind& level_objective();

}  // namespace softfinger
