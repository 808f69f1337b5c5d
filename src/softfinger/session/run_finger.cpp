#include "softfinger/session/run_finger.hpp"

namespace softfinger {

RunFinger::RunFinger(const RunSetup& setup, std::size_t finger, const RunOptions& options,
                     bool is_live, ThreadTeam* team)
    : tracker(setup, finger, options, is_live) {
  FingerChainOptions chain_of = chain_options(setup, finger);
  chain_of.with_state = options.record_state && options.recording;
  chain_of.team = team;
  chain_of.device_loop.objective = options.objective;
  ActuatorOptions& actuator = chain_of.device_loop.actuator;
  actuator.wait_for_device = options.wait_for_device;
  actuator.port = options.port;
  actuator.guard_program = options.guard_program;
  actuator.simulated_time = !is_live && options.as_fast_as_possible;
  chain = std::make_unique<FingerChain>(chain_of);
  if (!is_live || !chain->has_device()) return;
  std::unique_ptr<LiveTwin> twin;
  if (options.twin && finger == 0) {
    twin = std::make_unique<LiveTwin>(setup.wearer ? setup.wearer : setup.models[finger],
                                      setup.devices[finger]);
  }
  live = std::make_unique<LiveDevice>(*chain, *setup.models[finger], std::move(twin));
}

void RunFinger::close() {
  live.reset();
  chain.reset();
  tracker.close();
}

}  // namespace softfinger
