#include "softfinger/objectives/stress.hpp"

namespace softfinger {

StressObjective::StressObjective(const std::shared_ptr<const FingerModel>& model,
                                 const std::shared_ptr<const Device>& device)
    : surface_(device, static_cast<int>(model->sample_nodes.size())),
      correction_(model, device, MatchingOptions{}, ForceAwareOptions::stress()),
      nodes_F_(model->mesh.nodes.size()) {}

const RenderedSurface& StressObjective::tick(const VirtualFinger& finger, double elapsed) {
  const RenderedSurface& surface = surface_.tick(finger.contact, elapsed);
  transform(finger.X_WF.inverse(), finger.nodes_W, nodes_F_);
  return correction_.tick(finger.contact, nodes_F_, surface, elapsed);
}

}  // namespace softfinger
