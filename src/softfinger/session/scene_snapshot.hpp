#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "softfinger/loop/device_loop.hpp"
#include "softfinger/loop/finger_loop.hpp"
#include "softfinger/session/live_feed.hpp"
#include "softfinger/session/run_setup.hpp"

namespace softfinger {

/// What the device thread tells the simulation thread after a tick.
struct DeviceFeedback {
  TickRecord tick;
  Pose X_FP;                                 ///< surface of the commanded q
  std::vector<Vector3> linkage_F;            ///< m; three points a leg, of the commanded q
  std::vector<SolidPiece> pieces;            ///< of the commanded q
  Configuration actual;                      ///< q where the servos say they are; empty: unknown
  DeviceState state = DeviceState::kHoming;  ///< on the wire
};

/// Feedback before the first tick, at home, with its vectors at full size.
[[nodiscard]] DeviceFeedback initial_feedback(const DeviceLoop& device);
/// Fills `feedback` after a tick; allocates nothing.
void read_device(const DeviceLoop& device, DeviceFeedback& feedback);

/// What the page needs once to draw this scene; takes up to a second a device. scene_names,
/// duration and whether there are twins are the caller's.
[[nodiscard]] SceneDescription describe(const RunSetup& setup);
/// A snapshot with every vector at full size.
[[nodiscard]] Snapshot initial_snapshot(const RunSetup& setup);
/// Fill one soft object, or one finger or its skin; allocate nothing. `nodes` of all of its mesh,
/// W, m.
void fill(Snapshot::SoftObject& snapshot, const SoftSolid& solid, const Pose& X_WO,
          std::span<const Vector3> nodes);
void fill(Snapshot::Skin& snapshot, const ContactSet& contact);
void fill(Snapshot::Finger& snapshot, const FingerLoop& loop);
void fill(Snapshot::Finger& snapshot, const DeviceFeedback& feedback);

}  // namespace softfinger
