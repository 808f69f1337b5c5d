#include "softfinger/objectives/surface.hpp"

#include <utility>

namespace softfinger {

SurfaceObjective::SurfaceObjective(const std::shared_ptr<const FingerModel>& model,
                                   std::shared_ptr<const Device> device)
    : surface_(std::move(device), static_cast<int>(model->sample_nodes.size())) {}

const RenderedSurface& SurfaceObjective::tick(const VirtualFinger& finger, double elapsed) {
  return surface_.tick(finger.contact, elapsed);
}

}  // namespace softfinger
