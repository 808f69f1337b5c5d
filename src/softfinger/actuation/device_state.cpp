#include "softfinger/actuation/device_state.hpp"

namespace softfinger {
namespace {

// Times of ticks are sums of tick periods; equality must not hang on their last bit.
constexpr double kTimeRounding = 1e-9;

}  // namespace

DeviceState DeviceStateMachine::advance(const Tick& tick) {
  const double last_time = last_time_;
  last_time_ = tick.time;
  if (state_ == DeviceState::kStopped) return state_;

  if (state_ == DeviceState::kRetracting && tick.arrived && !retracted_) {
    retracted_ = true;
    retracted_since_ = last_time;
  }
  if (!tick.tracked && !lost_) lost_since_ = tick.time;
  lost_ = !tick.tracked;

  if (tick.ending && !ending_) ending_since_ = tick.time;
  ending_ = tick.ending;

  const bool lost_long = lost_ && tick.time - lost_since_ >= kHoldTime - kTimeRounding;
  if (tick.ending || tick.stalled || tick.emergency || lost_long) {
    const bool done =
        retracted_ && tick.time - retracted_since_ > kRetractedRepeatTime + kTimeRounding;
    const bool given_up = tick.time - ending_since_ > kLongestRetraction;
    if (tick.ending && (done || given_up)) return state_ = DeviceState::kStopped;
    return state_ = DeviceState::kRetracting;
  }
  if (lost_) return state_ = DeviceState::kHolding;
  retracted_ = false;
  const bool away = state_ == DeviceState::kRetracting || state_ == DeviceState::kHolding;
  if (away || (state_ == DeviceState::kHoming && !tick.arrived)) {
    return state_ = DeviceState::kHoming;
  }
  return state_ = tick.touching ? DeviceState::kRendering : DeviceState::kReady;
}

}  // namespace softfinger
