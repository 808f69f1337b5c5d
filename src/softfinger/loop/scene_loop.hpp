#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "softfinger/loop/finger_chain.hpp"
#include "softfinger/world/world.hpp"

namespace softfinger {

/// Steps the chains of a scene: each by itself, or where objects move by the forces on them, all
/// together with these. Runs, replays and the library go through the same calls.
class SceneLoop {
 public:
  /// `objects` must outlive the loop, as must the `team` that chains are shared out to; null: they
  /// follow one another. gravity in m/s^2, W; simulation_rate in Hz. `with_state`: records of soft
  /// objects carry their nodes. Throws InputError, see World.
  SceneLoop(std::span<const VirtualObject> objects, const Vector3& gravity, double simulation_rate,
            ThreadTeam* team, bool with_state = false);
  /// In the order of the scene; each must outlive the loop.
  void add(FingerChain& chain);

  /// Objects where the scene has them, before the chains start. `wanted`: where bones of hands are
  /// tracked and others held, a row for each object of the scene; empty: nobody says.
  void start(std::span<const FollowRecord> wanted = {});
  /// Step `step` (from 1) of every chain, with a pose for each, and of the objects. Allocates
  /// nothing.
  void step(std::int64_t step, std::span<const TrackedInput> tracked,
            std::span<const FollowRecord> wanted = {});

  /// Whether any object moves by forces.
  [[nodiscard]] bool moves_objects() const { return world_.has_value(); }
  /// Objects that start inside each other, once started.
  [[nodiscard]] std::span<const Overlap> overlaps() const {
    return world_ ? world_->overlaps() : std::span<const Overlap>();
  }
  /// Where an object is after the last step.
  [[nodiscard]] Pose object_pose(std::size_t object) const;
  /// Nodes of a soft object after the last step, W, m; of a rigid one none.
  [[nodiscard]] std::span<const Vector3> object_nodes(std::size_t object) const;
  /// A row for each object that moves by forces, in their order, after the last step.
  [[nodiscard]] std::span<const ObjectRecord> objects() const { return records_; }
  /// One that has the size of any of these.
  [[nodiscard]] ObjectRecord largest_object() const;
  /// What the last step, or the end, tells of them.
  [[nodiscard]] std::span<const EventRecord> events() const { return events_; }
  /// No step follows: events() tells what is open.
  void finish();
  /// Steps of objects that did not converge, beyond those that fingers tell of.
  [[nodiscard]] std::uint64_t unconverged_steps() const { return unconverged_steps_; }

 private:
  /// A bone of a hand, or what can be held: pulled no faster than a finger is.
  struct Follower {
    std::size_t object = 0;
    bool is_bone = false;
    bool led = false;  ///< a bone was seen; another is held
    Pose X_WT;
  };
  void follow(std::span<const FollowRecord> wanted);
  void record();
  void record_events();

  std::span<const VirtualObject> objects_;
  double simulation_rate_;
  ThreadTeam* team_;
  bool with_state_;
  std::optional<World> world_;
  std::vector<Follower> followers_;
  std::vector<FingerChain*> chains_;
  std::vector<std::uint8_t> takes_part_;        ///< by chain
  std::vector<FingerSimulation*> simulations_;  ///< of those
  std::vector<StepSummary> summaries_;          ///< and how they ended
  std::int64_t step_ = 0;
  std::uint64_t unconverged_steps_ = 0;
  std::vector<ObjectRecord> records_;
  std::vector<EventRecord> events_;
  std::int64_t events_told_ = 0;
};

}  // namespace softfinger
