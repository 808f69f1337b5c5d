#include "softfinger/actuation/guard_silence.hpp"

namespace softfinger {

bool GuardSilence::hangs(double silence, ProcessState state, double processor_time) noexcept {
  switch (state) {
    case ProcessState::kRunning:
      // One that waits for a processor is none of its own fault, and another would wait too.
      return silence >= kLongest && processor_time - processor_time_ >= kSpinning;
    case ProcessState::kInDriver:
      ++looks_in_driver_;
      return silence >= kInDriver && looks_in_driver_ >= kLooksInDriver;
    default:
      ++looks_asleep_;
      return silence >= kLongest && looks_asleep_ >= kLooksAsleep;
  }
}

}  // namespace softfinger
