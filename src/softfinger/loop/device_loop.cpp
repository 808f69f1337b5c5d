#include "softfinger/loop/device_loop.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

/// Of the emulated sensor's noise, beside the finger's number.
constexpr std::uint64_t kNoiseSeed = 2015;

}  // namespace

void note_way_here(const TrackedPose& tracked, double time, TickInput& input) {
  if (!tracked.valid || std::isnan(tracked.arrival)) return;
  input.waited = time - tracked.arrival;
  // A sender without a clock says that its poses took no time.
  if (tracked.time < tracked.arrival) input.exposure = tracked.arrival - tracked.time;
}

DeviceLoop::DeviceLoop(std::int64_t finger, const std::shared_ptr<const Device>& device,
                       const std::shared_ptr<const FingerModel>& model,
                       const DeviceLoopOptions& options)
    : device_(device), model_(model), stands_(device->home()), actuator_(device, options.actuator) {
  lead_by(options.objective != nullptr ? *options.objective : objective_kind(*device));
  leads_.refresh();
  record_.objective = number_of(*leads_.latest().kind);
  if (ForceLimiter::needed(*device)) limiter_ = std::make_unique<ForceLimiter>(*model, device);
  if (device->settings().force_sensor) {
    TravelOffsetOptions correction;
    correction.refine = device->settings().force_sensor->refine;
    offset_ = std::make_unique<TravelOffset>(model, device, correction);
    if (!options.replay) {
      sensor_ = std::make_unique<MeasuredForce>(
          options.wearer ? options.wearer : model, options.worn ? options.worn : device,
          MeasuredForce::Options{.seed = kNoiseSeed + static_cast<std::uint64_t>(finger),
                                 .live = !options.actuator.simulated_time});
    }
  }
  record_.finger = finger;
  record_.tick = -1;
  record_.wanted = device->home();
  record_.command.configuration = device->home();
  record_.command.joints.setZero(device->joint_count());
  device->clamped_joints(device->home(), record_.command.joints);
}

void DeviceLoop::lead_by(const ObjectiveKind& kind) {
  leads_.draft() = {&kind, kind.make(model_, device_)};
  leads_.publish();
}

const TickRecord& DeviceLoop::tick(const TickInput& input, const VirtualFinger& finger) {
  const double cpu_began = thread_cpu_time();
  const ContactSet& contact = finger.contact;
  const double elapsed = std::max(0.0, input.time - record_.time);
  leads_.refresh();
  const Lead& lead = leads_.latest();
  const RenderedSurface& surface = lead.objective->tick(finger, elapsed);
  Configuration corrected = surface.configuration;
  if (offset_) {
    if (reading_.configuration.size() > 0) {
      offset_->update(reading_, contact.friction_coefficient, elapsed);
    }
    record_.travel_offset = offset_->at(corrected);
    corrected = offset_->corrected(corrected);
  }
  const Configuration unlimited = corrected;
  if (limiter_ && corrected.allFinite()) {
    corrected = limiter_->limited(corrected, contact.friction_coefficient, elapsed);
  }
  record_.cpu_time = thread_cpu_time() - cpu_began;
  ++record_.tick;
  record_.step = input.step;
  record_.time = input.time;
  record_.tracked = input.tracked;
  // Once a tick: what is recorded is what is done.
  record_.emergency = input.emergency || actuator_.stop_latch().is_stopped();
  record_.reading = reading_;
  record_.objective = number_of(*lead.kind);
  record_.wanted = surface.configuration;
  record_.deviation = surface.deviation;
  record_.iterations = surface.iterations;
  record_.command = actuator_.command({.configuration = corrected,
                                       .tracked = input.tracked,
                                       .touching = contact.contact_count > 0,
                                       .emergency = record_.emergency},
                                      input.time);
  record_.command.force_limited = record_.command.force_limited || corrected != unlimited;
  note_latency(input);
  record_.hash = hash_of(record_);
  follow();
  if (sensor_) measure(contact.friction_coefficient, elapsed);
  return record_;
}

/// Leads what foresees forces along the way that the device really goes.
void DeviceLoop::follow() {
  const double cpu_began = thread_cpu_time();
  const Configuration& went = record_.command.configuration;
  if (limiter_) limiter_->follow(went);
  leads_.latest().objective->follow(offset_ ? offset_->felt(went) : went);
  record_.cpu_time += thread_cpu_time() - cpu_began;
}

void DeviceLoop::note_latency(const TickInput& input) {
  const auto formed = std::chrono::steady_clock::now();
  const auto seconds = [](auto duration) {
    return std::chrono::duration<double>(duration).count();
  };
  record_.latency = seconds(formed - input.taken);
  if (!std::isnan(input.waited)) record_.latency += input.waited;
  StageTimes& stages = record_.stages;
  stages[LatencyStage::kExposure] = input.exposure;
  stages[LatencyStage::kArrival] = input.waited;
  stages[LatencyStage::kStep] = seconds(input.handed - input.taken);
  stages[LatencyStage::kMatch] = seconds(formed - input.handed);
  const CommandDelivery delivery = actuator_.take_delivery().value_or(CommandDelivery());
  stages[LatencyStage::kSend] = delivery.send;
  stages[LatencyStage::kServo] = delivery.servo;
}

/// After the command, for the next tick.
void DeviceLoop::measure(double friction_coefficient, double elapsed) {
  JointAngles joints;
  if (!actuator_.read_servo_joints(joints)) {
    stands_ = record_.command.configuration;
  } else if (Configuration q; device().forward_kinematics(joints, q)) {
    // Between two commands the joints may stand for no pose of the workspace.
    stands_ = q;
  }
  reading_ = sensor_->measure(stands_, friction_coefficient, elapsed);
}

}  // namespace softfinger
