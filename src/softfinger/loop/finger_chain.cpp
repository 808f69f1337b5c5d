#include "softfinger/loop/finger_chain.hpp"

namespace softfinger {

FingerChain::FingerChain(const FingerChainOptions& options)
    : loop_(options.finger, options.model, options.objects, options.simulation_rate,
            options.with_state, options.team, options.hand),
      clock_(options.simulation_rate, options.device ? device_rate(*options.device) : 1.0) {
  if (!options.device) return;
  device_ = std::make_unique<DeviceLoop>(options.finger, options.device, options.model,
                                         options.device_loop);
}

const StepRecord& FingerChain::start(const TrackedInput& tracked) {
  loop_.start(tracked);
  return seal();
}

void FingerChain::step(std::int64_t step, const TrackedInput& tracked) {
  loop_.step(step, tracked);
  tick_is_due_ = device_ && clock_.ticks(step);
}

bool FingerChain::begin_step(std::int64_t step, const TrackedInput& tracked) {
  tick_is_due_ = device_ && clock_.ticks(step);
  return loop_.begin_step(step, tracked);
}

void FingerChain::end_step(const StepSummary& summary, FingerLoop::SolvingTime solving,
                           std::uint64_t world) {
  loop_.end_step(summary, solving);
  world_ = world;
}

TickInput FingerChain::tick_input(std::chrono::steady_clock::time_point taken) const {
  const StepRecord& step = loop_.record();
  return {.step = step.step,
          .time = step.time,
          .tracked = step.tracked.valid,
          .taken = taken,
          .handed = std::chrono::steady_clock::now()};
}

VirtualFinger FingerChain::virtual_finger() const {
  const FingerSimulation& simulation = loop_.simulation();
  return {loop_.contact(), simulation.positions(), simulation.bone_pose()};
}

const TickRecord& FingerChain::tick(const TickInput& input) {
  const TickRecord& tick = device_->tick(input, virtual_finger());
  know(tick.tick, tick.hash);
  return tick;
}

const TickRecord& FingerChain::tick(const TickInput& input, const VirtualFinger& finger) {
  return device_->tick(input, finger);
}

void FingerChain::know(std::int64_t tick, std::uint64_t hash) {
  known_tick_ = tick;
  known_hash_ = hash;
}

const StepRecord& FingerChain::seal() { return loop_.seal(known_tick_, known_hash_, world_); }

void FingerChain::finish() noexcept {
  if (device_) device_->actuator().finish();
}

}  // namespace softfinger
