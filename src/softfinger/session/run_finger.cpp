#include "softfinger/session/run_finger.hpp"

namespace softfinger {

RunFinger::RunFinger(const RunSetup& setup, std::size_t finger, const RunOptions& options,
                     bool is_live)
    : number(finger), tracker(setup, finger, options, is_live) {}

void RunFinger::open(const RunSetup& setup, const RunOptions& options, bool is_live,
                     ThreadTeam* team) {
  ActuatorOptions actuator = options.actuator;
  actuator.simulated_time = !is_live && options.as_fast_as_possible;
  FingerChainOptions chain_of = chain_options(setup, number, actuator);
  chain_of.with_state = options.record_state && options.recording;
  chain_of.team = team;
  chain_of.device_loop.objective = options.objective;
  chain = std::make_unique<FingerChain>(chain_of);
  if (!is_live || !chain->has_device()) return;
  std::unique_ptr<LiveTwin> twin;
  if (options.twin && number == 0) {
    twin = std::make_unique<LiveTwin>(
        setup.models[number], setup.wearer ? setup.wearer : setup.models[number],
        setup.worn[number] ? setup.worn[number] : setup.devices[number]);
  }
  live = std::make_unique<LiveDevice>(*chain, *setup.models[number], std::move(twin));
}

Actuator* RunFinger::actuator() const {
  return chain->has_device() ? &chain->device().actuator() : nullptr;
}

void RunFinger::lead_by(const ObjectiveKind& kind) {
  if (!chain->has_device()) return;
  led_by = &kind;
  chain->device().lead_by(kind);
}

void RunFinger::close() {
  live.reset();
  tracker.close();
}

}  // namespace softfinger
