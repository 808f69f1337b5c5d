#include "softfinger/objectives/published.hpp"

#include <utility>

namespace softfinger {

PublishedObjective::PublishedObjective(const std::shared_ptr<const FingerModel>& model,
                                       std::shared_ptr<const Device> device)
    : SurfaceObjective(model, std::move(device),
                       {.limits = MatchingLimits::kClamp, .separation = Separation::kConstant}) {}

}  // namespace softfinger
