#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "softfinger/actuation/actuator.hpp"
#include "softfinger/contact/contact_sums.hpp"
#include "softfinger/device/configuration.hpp"
#include "softfinger/device/force_reading.hpp"
#include "softfinger/geometry/pose.hpp"
#include "softfinger/recording/latency_stages.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// A pose as it is stored: translation (m) and unit quaternion. Turning it into a Pose gives the
/// same bits every time, which the way from a rotation matrix to a quaternion and back does not.
/// Has no negative zeros: SQLite does not keep them.
struct StoredPose {
  Vector3 translation = Vector3::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();

  StoredPose() = default;
  explicit StoredPose(const Pose& pose)
      : translation(pose.translation.array() + 0.0),
        rotation(Eigen::Quaterniond(pose.rotation).normalized()) {
    rotation.coeffs().array() += 0.0;
  }
  [[nodiscard]] Pose pose() const { return {rotation.toRotationMatrix(), translation}; }
};

/// What one step takes from its tracker, as it is recorded.
struct TrackedInput {
  StoredPose X_WFt;
  double time = 0.0;   ///< s, when the pose was true
  bool valid = false;  ///< false while tracking is lost

  TrackedInput() = default;
  explicit TrackedInput(const TrackedPose& tracked)
      : X_WFt(tracked.X_WFt), time(tracked.time), valid(tracked.valid) {}
};

/// Skin sample as recorded with the whole state.
struct SampleRecord {
  Vector3 position_F = Vector3::Zero();  ///< m
  double gap = 0.0;                      ///< m
  Vector3 force_F = Vector3::Zero();     ///< normal and tangential together, N
  double in_contact = 0.0;               ///< 1 for members of C, else 0
};

/// One finger in one step, with the sums of its contact, in which normal_force_sum and
/// tangential_force_F are NaN where a recording does not say them. Step 0 is the pose the run
/// starts from.
struct StepRecord : ContactSums {
  std::int64_t finger = 0;
  std::int64_t step = 0;
  double time = 0.0;  ///< s, end of the step
  TrackedInput tracked;
  // What the step computed; compared bit by bit by a replay, as the sums are.
  StoredPose X_WF;  ///< bone
  std::int64_t iterations = 0;
  bool converged = true;
  double residual = 0.0;   ///< relative
  std::int64_t tick = -1;  ///< newest device tick known to this step; -1: none
  std::uint64_t hash = 0;  ///< of all above, the finger's whole state, and that tick's hash
  // Not compared.
  double cpu_time = 0.0;   ///< s, simulation thread
  double wall_time = 0.0;  ///< s
  // Only with the whole state recorded, else empty.
  std::vector<Vector3> nodes_W;  ///< m
  std::vector<SampleRecord> samples;
};

/// One finger's device tick.
struct TickRecord {
  std::int64_t finger = 0;
  std::int64_t tick = 0;  ///< counts the ticks taken, from 0
  std::int64_t step = 0;  ///< whose contact set was rendered
  double time = 0.0;      ///< s, of that step
  bool tracked = true;
  bool emergency = false;  ///< the device was to retract
  /// What the device's force sensor said last, an input of the tick; no configuration: nothing.
  ForceReading reading;
  /// By which objective the device is led, an input of the tick: its place among
  /// kDeviceObjectives; NaN: the device file's.
  double objective = std::numeric_limits<double>::quiet_NaN();
  // What the tick computed; compared bit by bit by a replay.
  Configuration wanted;    ///< q of the match; rad and m
  double deviation = 0.0;  ///< E at the match's q, m^2
  std::int64_t iterations = 0;
  double travel_offset = 0.0;  ///< taken off `wanted`, see TravelOffset, m
  FormedCommand command;
  std::uint64_t hash = 0;  ///< of all above
  // Not compared.
  double cpu_time = 0.0;  ///< s, of the match, device thread
  double latency = 0.0;   ///< s, arrival of the pose to the formed command
  StageTimes stages;      ///< send and servo: of the newest command that was sent; not recorded
};

/// An object that moves by the forces on it, in one step; step 0 is where it starts. Compared bit
/// by bit by a replay.
struct ObjectRecord {
  std::int64_t object = 0;  ///< its number in the scene
  std::int64_t step = 0;
  double time = 0.0;  ///< s, end of the step
  StoredPose X_WO;
  Vector3 velocity = Vector3::Zero();          ///< of its centre of mass, W, m/s
  Vector3 angular_velocity = Vector3::Zero();  ///< W, rad/s
  /// Of a slider (m) or hinge (rad); NaN: it has neither.
  double joint = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vector3> nodes_W;  ///< of a soft one, with the whole state recorded; else empty; m
};

/// Where an object is wanted from this step on, an input: a bone of a hand where it is tracked (at
/// step 0 where it starts), another one that moves by forces where a person holds it. A row where
/// that changes.
struct FollowRecord {
  std::int64_t object = 0;  ///< its number in the scene
  std::int64_t step = 0;
  StoredPose X_WT;
  bool valid = false;  ///< false, with the last pose: tracking is lost, or nobody holds it
};

/// Something that happened to an object that moves, as told in a step; what is told after the last
/// one has its number. Compared bit by bit by a replay.
struct EventRecord {
  std::int64_t step = 0;
  std::int64_t number = 0;  ///< counts on from 0
  double time = 0.0;        ///< s, when it happened
  std::int64_t kind = 0;    ///< its place among kEventKinds
  std::int64_t object = 0;  ///< number in the scene
  /// Likewise; a finger's counts on from the objects; -1: none.
  std::int64_t other = -1;
  double impulse = std::numeric_limits<double>::quiet_NaN();  ///< N s; NaN: none
};
inline constexpr std::array kEventKinds = {"impact", "release", "click", "detent", "limit"};

/// Sum over everything of a tick that a replay must reproduce.
[[nodiscard]] std::uint64_t hash_of(const TickRecord& tick);
/// The same for a step; `state` is the hash of the finger's whole state, `tick` that of the tick
/// named by the record (0 if none).
[[nodiscard]] std::uint64_t hash_of(const StepRecord& step, std::uint64_t state,
                                    std::uint64_t tick);

/// What of `step` and `replayed` differs first, by its name ("tracked pose", "bone pose", ...);
/// null where all bits agree.
[[nodiscard]] const char* first_difference(const StepRecord& recorded, const StepRecord& replayed);
[[nodiscard]] const char* first_difference(const TickRecord& recorded, const TickRecord& replayed);
[[nodiscard]] const char* first_difference(const ObjectRecord& recorded,
                                           const ObjectRecord& replayed);
[[nodiscard]] const char* first_difference(const EventRecord& recorded,
                                           const EventRecord& replayed);

}  // namespace softfinger
