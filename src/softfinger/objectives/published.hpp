#pragma once

#include <memory>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/matching/levenberg_marquardt.hpp"
#include "softfinger/matching/packed_samples.hpp"
#include "softfinger/matching/skin_points.hpp"
#include "softfinger/objectives/objective.hpp"

namespace softfinger {

/// "published": contact surface matching as Perez et al., "Soft finger tactile rendering for
/// wearable haptics", IEEE World Haptics 2015, have it. Every tick Levenberg-Marquardt from the
/// last answer, at first from home, with one separation for all samples and no limits; then joint
/// angles are cut to theirs. Nothing else: off the skin it stays where it was, clear of it.
class PublishedObjective final : public Objective {
 public:
  PublishedObjective(const std::shared_ptr<const FingerModel>& model,
                     std::shared_ptr<const Device> device);

  const RenderedSurface& tick(const VirtualFinger& finger, double elapsed) override;

 private:
  std::shared_ptr<const Device> device_;
  LevenbergMarquardt minimiser_;
  SkinPoints points_;
  PackedSamples packed_;
  RenderedSurface rendered_;
};

}  // namespace softfinger
