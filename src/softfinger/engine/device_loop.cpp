#include "softfinger/engine/device_loop.hpp"

#include <algorithm>

#include "softfinger/base/thread_clock.hpp"
#include "softfinger/matching/contact_plane.hpp"

namespace softfinger {
namespace {

MatchingOptions matching_options(Objective objective) {
  MatchingOptions options;
  if (objective == Objective::kPublished) {
    options.limits = MatchingLimits::kClamp;
    options.separation = Separation::kConstant;
  }
  return options;
}

}  // namespace

DeviceLoop::DeviceLoop(std::int64_t finger, const std::shared_ptr<const Device>& device,
                       const std::shared_ptr<const FingerModel>& model,
                       const ActuatorOptions& options, std::optional<Objective> objective)
    : objective_(objective ? *objective
                           : objective_of(device->settings().matching.objective).value()),
      rendering_(device, static_cast<int>(model->sample_nodes.size()),
                 matching_options(objective_)),
      actuator_(device, options) {
  if (objective_ == Objective::kSurfaceAndForce) {
    force_ = std::make_unique<ForceRendering>(model, device);
  }
  record_.finger = finger;
  record_.tick = -1;
  record_.wanted = device->home();
  record_.command.configuration = device->home();
  record_.command.joints.setZero(device->joint_count());
  device->clamped_joints(device->home(), record_.command.joints);
}

const TickRecord& DeviceLoop::tick(std::int64_t step, double time, bool tracked,
                                   const ContactSet& contact,
                                   std::chrono::steady_clock::time_point arrival) {
  const double cpu_began = thread_cpu_time();
  const RenderedSurface* rendered = &rendering_.tick(contact);
  if (force_) rendered = &force_->tick(contact, *rendered, std::max(0.0, time - record_.time));
  RenderedSurface surface = *rendered;
  if (objective_ == Objective::kContactPlane && contact.contact_count > 0) {
    surface.configuration = contact_plane(rendering_.device(), contact, surface.configuration);
  }
  record_.cpu_time = thread_cpu_time() - cpu_began;
  ++record_.tick;
  record_.step = step;
  record_.time = time;
  record_.tracked = tracked;
  record_.wanted = surface.configuration;
  record_.deviation = surface.deviation;
  record_.iterations = surface.iterations;
  record_.command = actuator_.command({.configuration = surface.configuration,
                                       .tracked = tracked,
                                       .touching = contact.contact_count > 0},
                                      time);
  record_.latency =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - arrival).count();
  record_.hash = hash_of(record_);
  return record_;
}

}  // namespace softfinger
