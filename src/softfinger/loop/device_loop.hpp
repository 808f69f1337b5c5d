#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>

#include "softfinger/actuation/actuator.hpp"
#include "softfinger/actuation/force_limiter.hpp"
#include "softfinger/contact/contact_set.hpp"
#include "softfinger/loop/measured_force.hpp"
#include "softfinger/loop/travel_offset.hpp"
#include "softfinger/objectives/objective_kinds.hpp"
#include "softfinger/recording/record.hpp"
#include "softfinger/threads/mailbox.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// What a device tick is about.
struct TickInput {
  std::int64_t step = 0;
  double time = 0.0;       ///< s, end of that step
  bool tracked = true;     ///< the tracker knows where the finger is
  bool emergency = false;  ///< the device was stopped: for a replay, which has no latch
  /// Stages before the step: NaN where they are not known.
  double exposure = std::numeric_limits<double>::quiet_NaN();  ///< s
  double waited = std::numeric_limits<double>::quiet_NaN();    ///< s, the pose for the step
  std::chrono::steady_clock::time_point taken;                 ///< when the step took the pose
  std::chrono::steady_clock::time_point handed;                ///< when its contact was handed on
};

/// As far as `tracked` tells, of the step that takes it at run time `time` (s).
void note_way_here(const TrackedPose& tracked, double time, TickInput& input);

struct DeviceLoopOptions {
  ActuatorOptions actuator;
  const ObjectiveKind* objective = nullptr;  ///< null: the device file's
  /// Whom an emulated force sensor presses; null: the simulated finger.
  std::shared_ptr<const FingerModel> wearer = nullptr;
  /// The device as it sits on the wearer, where that is not as on the model; null: the same.
  std::shared_ptr<const Device> worn = nullptr;
  /// There is no sensor: replay_reading() says what one said.
  bool replay = false;
};

/// The device side of one finger: contact set to motor command, tick by tick. The same code serves
/// headless and live runs, replays and the library. Where the device measures force, the reading of
/// one tick corrects the next.
class DeviceLoop {
 public:
  /// `model`: the simulated finger. Throws InputError where the port cannot be opened.
  DeviceLoop(std::int64_t finger, const std::shared_ptr<const Device>& device,
             const std::shared_ptr<const FingerModel>& model, const DeviceLoopOptions& options);

  /// One device tick. Allocates nothing, takes no lock, throws nothing.
  const TickRecord& tick(const TickInput& input, const VirtualFinger& finger);
  /// Before a tick that is replayed.
  void replay_reading(const ForceReading& reading) { reading_ = reading; }
  /// From the next tick on the device is led by this, which begins where nothing is known of the
  /// past. One thread, not of the loop: it makes, and forgets, objectives.
  void lead_by(const ObjectiveKind& kind);
  /// The last tick; tick -1 before the first.
  [[nodiscard]] const TickRecord& record() const { return record_; }
  [[nodiscard]] const Device& device() const { return *device_; }
  [[nodiscard]] Actuator& actuator() { return actuator_; }
  [[nodiscard]] const Actuator& actuator() const { return actuator_; }

 private:
  /// What leads the device. The mailbox keeps the one that is in use away from who makes others.
  struct Lead {
    const ObjectiveKind* kind = nullptr;
    std::unique_ptr<Objective> objective;
  };

  void measure(double friction_coefficient, double elapsed);
  void follow();
  void note_latency(const TickInput& input);

  std::shared_ptr<const Device> device_;
  std::shared_ptr<const FingerModel> model_;
  Mailbox<Lead> leads_;
  std::unique_ptr<TravelOffset> offset_;   ///< null: force is not measured
  std::unique_ptr<ForceLimiter> limiter_;  ///< null: no limit that hangs on the way
  std::unique_ptr<MeasuredForce> sensor_;  ///< null: none
  ForceReading reading_;                   ///< newest; no configuration: none yet
  Configuration stands_;                   ///< where the device is, as far as known
  Actuator actuator_;
  TickRecord record_;
};

}  // namespace softfinger
