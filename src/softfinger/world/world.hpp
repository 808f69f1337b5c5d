#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "softfinger/contact/virtual_object.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/world/object_state.hpp"
#include "softfinger/world/world_events.hpp"

namespace softfinger {

class ThreadTeam;

/// Two objects that start inside each other, or a bone of a hand that appears inside something.
struct Overlap {
  std::size_t first = 0, second = 0;  ///< numbers in the scene
  double depth = 0.0;                 ///< m
  double time = 0.0;                  ///< when, s; 0: at the start
};

/// What the last step of a world took.
struct StepWork {
  std::size_t islands = 0;   ///< that had bodies or something soft
  std::size_t sleeping = 0;  ///< bodies, rigid and soft
  std::size_t near = 0;      ///< points of objects that might have touched
  long evaluations = 0;      ///< of bodies
};

/// The objects of a scene that move by the forces on them, and the steps in which they and the
/// fingers that touch them move together. After the first steps nothing allocates, and nothing
/// throws.
///
///     world.reset();
///     each step:
///       world.begin_step(time);             // where objects are expected
///       finger.begin_step(X_WFt, time);     // each that takes part
///       world.solve(fingers);
///       finger.end_step();
class World {
 public:
  /// `objects` must outlive the world, as must the `team` that fingers share. gravity in m/s^2, W;
  /// time_step in s. Throws InputError where joints make a loop or a shape has no volume.
  World(std::span<const VirtualObject> objects, const Vector3& gravity, double time_step,
        ThreadTeam* team = nullptr);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// Whether any object moves by forces: else there is nothing to step.
  [[nodiscard]] bool moves() const;
  /// A finger that is to touch these objects, before reset(); it must outlive the world.
  void add(FingerSimulation& finger);
  /// Objects as the scene has them at the start.
  void reset();

  /// Which of them, at least one of two moving, start inside each other, and which bones have
  /// appeared inside something so far, the first kMostOverlaps; they part slowly.
  static constexpr std::size_t kMostOverlaps = 256;
  [[nodiscard]] std::span<const Overlap> overlaps() const;

  /// Where object o, a bone of a hand, is tracked at the end of the next step; null: it is nowhere,
  /// as it is until somebody has seen it. It is pulled there, and appears where it was nowhere.
  void follow(std::size_t o, const Pose* X_WT);

  /// A person holds object o, which moves by forces as a whole and is no bone, where it is at the
  /// end of the next step: a spring pulls it there, no harder than its weight needs and a hand
  /// gives. Null: nobody does, and it goes on as it moved.
  void hold(std::size_t o, const Pose* X_WT);

  void begin_step(double time);
  /// Ends the step of objects together with that of the fingers, which have begun theirs. One
  /// summary a finger.
  void solve(std::span<FingerSimulation* const> fingers, std::span<StepSummary> summaries);

  /// What the last step tells of objects that move; a finger's number is that of the objects and
  /// of the fingers added before it.
  [[nodiscard]] std::span<const WorldEvent> events() const;
  /// No step follows: events() tells what is open.
  void finish();

  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] const ObjectState& state(std::size_t object) const;
  /// Nodes of a soft object, W, m; of a rigid one none.
  [[nodiscard]] std::span<const Vector3> nodes(std::size_t object) const;
  /// How the objects' step ended: the most that any island took.
  [[nodiscard]] const StepSummary& summary() const;
  [[nodiscard]] const StepWork& work() const;
  /// 64-bit hash of all that the next step depends on.
  [[nodiscard]] std::uint64_t state_hash() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
