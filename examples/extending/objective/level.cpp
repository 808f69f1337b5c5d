#include "level.hpp"

#include <utility>

#include "softfinger/matching/limit_clamp.hpp"

namespace softfinger {

LevelObjective::LevelObjective(const std::shared_ptr<const FingerModel>& model,
                               std::shared_ptr<const Device> device)
    : device_(std::move(device)), surface_(device_, static_cast<int>(model->sample_nodes.size())) {}

const RenderedSurface& LevelObjective::tick(const VirtualFinger& finger, double elapsed) {
  rendered_ = surface_.tick(finger.contact, elapsed);
  const int axis = device_->approach_axis();
  if (axis < 0) return rendered_;
  Configuration level = device_->home();
  level[axis] = rendered_.configuration[axis];
  rendered_.configuration = device_->reachable(level) ? level : clamped_to_limits(*device_, level);
  static_cast<void>(device_->inverse_kinematics(rendered_.configuration, rendered_.joints));
  return rendered_;
}

const ObjectiveKind& level_objective() {
  static const ObjectiveKind kKind{
      .name = "level",
      .words = "travel alone",
      .make = [](const std::shared_ptr<const FingerModel>& model,
                 const std::shared_ptr<const Device>& device) -> std::unique_ptr<Objective> {
        return std::make_unique<LevelObjective>(model, device);
      }};
  return kKind;
}

}  // namespace softfinger
