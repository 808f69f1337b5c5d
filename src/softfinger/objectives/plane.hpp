#pragma once

#include <memory>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/matching/packed_samples.hpp"
#include "softfinger/matching/skin_points.hpp"
#include "softfinger/objectives/objective.hpp"

namespace softfinger {

/// "plane", the simplest rendering there is: in contact the surface through the force-weighted
/// centroid of the contact, facing along its mean normal (see on_plane()), brought into the
/// workspace. Off the skin as "surface".
class PlaneObjective final : public Objective {
 public:
  PlaneObjective(const std::shared_ptr<const FingerModel>& model,
                 std::shared_ptr<const Device> device);

  const RenderedSurface& tick(const VirtualFinger& finger, double elapsed) override;

 private:
  std::shared_ptr<const Device> device_;
  SurfaceFollowing surface_;
  SkinPoints points_;
  PackedSamples packed_;
  RenderedSurface rendered_;
};

}  // namespace softfinger
