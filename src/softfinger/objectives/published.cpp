#include "softfinger/objectives/published.hpp"

#include <utility>

#include "softfinger/matching/limit_clamp.hpp"

namespace softfinger {
namespace {

constexpr MatchingOptions kAsPublished{.limits = MatchingLimits::kClamp,
                                       .separation = Separation::kConstant};

}  // namespace

PublishedObjective::PublishedObjective(const std::shared_ptr<const FingerModel>& model,
                                       std::shared_ptr<const Device> device)
    : device_(std::move(device)),
      minimiser_(*device_),
      points_(static_cast<int>(model->sample_nodes.size())),
      packed_(static_cast<int>(model->sample_nodes.size() + ContactSet::kMostFeatures)) {
  rendered_.configuration = device_->home();
}

const RenderedSurface& PublishedObjective::tick(const VirtualFinger& finger, double /*elapsed*/) {
  ContactPoints points = points_.take(finger.contact);
  points.shares = {};
  const SurfaceSamples samples =
      packed_.pack(points, kAsPublished, device_->settings().matching.separation_tolerance);
  const LevenbergMarquardt::Outcome found = minimiser_.minimise(samples, rendered_.configuration);
  rendered_.configuration = clamped_to_limits(*device_, found.q);
  static_cast<void>(device_->inverse_kinematics(rendered_.configuration, rendered_.joints));
  const bool touches = finger.contact.contact_count > 0;
  rendered_.state = touches ? RenderingState::kTouching : RenderingState::kHome;
  rendered_.deviation = touches ? device_->deviation(rendered_.configuration, samples) : 0.0;
  rendered_.iterations = found.iterations;
  rendered_.termination = found.termination;
  return rendered_;
}

}  // namespace softfinger
