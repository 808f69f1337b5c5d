#include "softfinger/objectives/surface_and_force.hpp"

namespace softfinger {

SurfaceAndForceObjective::SurfaceAndForceObjective(const std::shared_ptr<const FingerModel>& model,
                                                   const std::shared_ptr<const Device>& device)
    : surface_(device, static_cast<int>(model->sample_nodes.size())), correction_(model, device) {}

const RenderedSurface& SurfaceAndForceObjective::tick(const VirtualFinger& finger, double elapsed) {
  const RenderedSurface& surface = surface_.tick(finger.contact, elapsed);
  return correction_.tick(finger.contact, {}, surface, elapsed);
}

}  // namespace softfinger
