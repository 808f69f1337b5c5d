#include "softfinger/engine/device_loop.hpp"

#include "softfinger/base/thread_clock.hpp"

namespace softfinger {

DeviceLoop::DeviceLoop(std::int64_t finger, const std::shared_ptr<const Device>& device,
                       std::size_t samples, const ActuatorOptions& options)
    : rendering_(device, static_cast<int>(samples)), actuator_(device, options) {
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
  const RenderedSurface& surface = rendering_.tick(contact);
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
