#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/contact/virtual_object.hpp"
#include "softfinger/geometry/tetrahedral_mesh.hpp"

namespace softfinger {

class DeformingSurface;
class FingerModel;
class FingerPotential;
class SurfacePatches;
class ThreadTeam;

/// How one step ended.
struct StepSummary {
  int iterations = 0;
  bool converged = true;
  double relative_residual = 0.0;
};

/// A finger exploring virtual objects: each step() is one implicit Euler step of skin and bone.
/// step() allocates nothing after the first call and throws nothing.
class FingerSimulation {
 public:
  /// `objects` must outlive the simulation, as must the `team` that shares the steps of large
  /// meshes; the bits are the same with and without. time_step in s. `hand`: the number of the hand
  /// whose finger it is, which meets none of that hand's bones; -1: none's.
  FingerSimulation(std::shared_ptr<const FingerModel> model, std::span<const VirtualObject> objects,
                   double time_step, ThreadTeam* team = nullptr, int hand = -1);
  /// Object `self` of them, a soft one: a finger whose bone, the nodes that are held, is where it
  /// is put. gravity in W, m/s^2.
  FingerSimulation(std::span<const VirtualObject> objects, std::size_t self, const Vector3& gravity,
                   double time_step, ThreadTeam* team = nullptr);
  ~FingerSimulation();
  FingerSimulation(FingerSimulation&&) noexcept;
  FingerSimulation& operator=(FingerSimulation&&) noexcept;

  /// Rest shape at rest at X_WFt, no contact history.
  void reset(const Pose& X_WFt, double time = 0.0);
  /// The same for a finger that is nowhere: nothing is near it, whatever stands at X_WFt. For as
  /// long as no step is made.
  void put_aside(const Pose& X_WFt);
  /// Advances to the end of the step, `time` (s), where the tracked finger is at X_WFt. Objects
  /// with dynamics stay where they are put.
  StepSummary step(const Pose& X_WFt, double time);

  // The same in parts, where a world moves such objects in the same step: each is put where it may
  // be expected, the step begins, all is minimised together by way of potential() and
  // move_object() instead of solve_step(), and the step ends.
  void begin_step(const Pose& X_WFt, double time);
  StepSummary solve_step();
  void end_step();
  /// Instead of these, a step in which it rests: only scripted objects move, where it meets none.
  void pass_step(double time);
  /// It has come to rest: nothing of it moves.
  void rest();
  /// Object o stands there now and at the start of the next step.
  void put_object(std::size_t o, const Pose& X_WO);
  /// Object o is expected there at the end of the next step.
  void expect_object(std::size_t o, const Pose& X_WO);
  /// Object o stands there within a step, as far as evaluations go.
  void move_object(std::size_t o, const Pose& X_WO);
  /// Where soft object o may be touched in the next step; its surface stands as it does now.
  void find_patches(std::size_t o, const DeformingSurface& surface);
  /// The nodes of soft object o stand there within a step, W, m.
  void follow_surface(std::size_t o, std::span<const Vector3> nodes);
  [[nodiscard]] const SurfacePatches& patches(std::size_t o) const;
  [[nodiscard]] FingerPotential& potential();
  [[nodiscard]] const FingerPotential& potential() const;

  [[nodiscard]] const FingerModel& model() const;
  /// Whether object o can be touched at all: none of its own hand.
  [[nodiscard]] bool may_touch(std::size_t o) const;
  [[nodiscard]] const Pose& bone_pose() const;                ///< X_WF
  [[nodiscard]] const ContactSet& contact() const;            ///< of the last step
  [[nodiscard]] std::span<const Vector3> positions() const;   ///< all nodes, in W, m
  [[nodiscard]] std::span<const Vector3> velocities() const;  ///< all nodes, in W, m/s
  /// 64-bit hash of the whole state: same bits, same hash.
  [[nodiscard]] std::uint64_t state_hash() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace softfinger
