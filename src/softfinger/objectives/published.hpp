#pragma once

#include <memory>

#include "softfinger/objectives/surface.hpp"

namespace softfinger {

/// "published", a baseline: contact surface matching as in Perez et al., "Soft finger tactile
/// rendering for wearable haptics", IEEE World Haptics 2015: one separation for all samples, joint
/// angles cut to their limits afterwards.
class PublishedObjective final : public SurfaceObjective {
 public:
  PublishedObjective(const std::shared_ptr<const FingerModel>& model,
                     std::shared_ptr<const Device> device);
};

}  // namespace softfinger
