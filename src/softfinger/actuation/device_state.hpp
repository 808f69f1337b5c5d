#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "softfinger/base/name_table.hpp"

namespace softfinger {

/// What a device is doing, as the page and the log name it.
enum class DeviceState : std::uint8_t {
  kDisconnected,  ///< its port is not open; attempts to open it go on
  kHoming,        ///< moving to where the loop wants it for the first time, or again after a gap
  kReady,         ///< follows commands, nothing is touched
  kRendering,     ///< follows commands, something is touched
  kHolding,       ///< tracking lost for less than kHoldTime: keeps its last pose
  kRetracting,    ///< moving to the retracted pose, or there and still repeating the command
  kStopped,       ///< no command follows
};

/// How much a state asks of a person: nothing; to feel what is touched; to know that the device
/// does not follow; to look after the device.
enum class Tone { kPlain, kTouching, kWarning, kFault };
inline constexpr std::array<std::string_view, 4> kToneNames{"plain", "touching", "warning",
                                                            "fault"};

struct DeviceStateRow {
  DeviceState value;
  std::string_view name;
  Tone tone;
  std::string_view words;
};
/// The most urgent first: what people are told of several devices.
inline constexpr std::array<DeviceStateRow, 7> kDeviceStates{{
    {DeviceState::kDisconnected, "disconnected", Tone::kFault,
     "its port is not open; attempts to open it go on"},
    {DeviceState::kStopped, "stopped", Tone::kPlain, "no command follows"},
    {DeviceState::kRetracting, "retracting", Tone::kWarning,
     "moves to the retracted pose, or is there and still told so"},
    {DeviceState::kHolding, "holding", Tone::kWarning,
     "tracking is lost for less than 200 ms: it keeps its last pose"},
    {DeviceState::kHoming, "homing", Tone::kPlain,
     "moves to where the loop wants it for the first time, or again after a gap"},
    {DeviceState::kRendering, "rendering", Tone::kTouching,
     "follows commands, something is touched"},
    {DeviceState::kReady, "ready", Tone::kPlain, "follows commands, nothing is touched"},
}};

/// "ready", "rendering", ...
[[nodiscard]] constexpr std::string_view state_name(DeviceState state) {
  return row_of(kDeviceStates, state).name;
}

/// Tracking lost for longer than this (s) retracts the device.
inline constexpr double kHoldTime = 0.2;
/// No fresh command for longer than this (s, and at least three device ticks) retracts the device.
inline constexpr double kStallTime = 0.1;
/// How long (s) the command is repeated after the retracted pose is reached at the end of a run.
inline constexpr double kRetractedRepeatTime = 0.3;
/// A retraction at the end of a run that takes longer (s) is given up.
inline constexpr double kLongestRetraction = 30.0;

/// What happens to a device as time passes, without any I/O: a pure state machine.
class DeviceStateMachine {
 public:
  /// What the loop says at one device tick.
  struct Tick {
    double time = 0.0;       ///< s, never decreasing
    bool tracked = true;     ///< the tracker knows where the finger is
    bool touching = false;   ///< something is in contact
    bool ending = false;     ///< the run ends: retract and stop
    bool emergency = false;  ///< emergency stop: retract at once, until it is released
    bool stalled = false;    ///< the loop gave no fresh command for kStallTime
    bool arrived = false;    ///< the last command was the pose the present state moves to
  };

  /// Returns the state for this tick's command.
  DeviceState advance(const Tick& tick);
  [[nodiscard]] DeviceState state() const { return state_; }

 private:
  DeviceState state_ = DeviceState::kHoming;
  double last_time_ = 0.0;
  bool lost_ = false;
  double lost_since_ = 0.0;  ///< valid while lost_
  bool retracted_ = false;   ///< the retracted pose was commanded
  double retracted_since_ = 0.0;
  bool ending_ = false;
  double ending_since_ = 0.0;  ///< valid while ending_
};

}  // namespace softfinger
