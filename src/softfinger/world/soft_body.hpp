#pragma once

#include <span>
#include <vector>

#include "softfinger/contact/deforming_surface.hpp"
#include "softfinger/contact/virtual_object.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/world/object_state.hpp"

namespace softfinger {

class ThreadTeam;

/// A soft object of the scene, as it is stepped and as others meet it.
class SoftBody {
 public:
  /// The scene's object of this number. Throws InputError where its boundary is not that of a
  /// solid.
  SoftBody(std::span<const VirtualObject> objects, std::size_t object, const Vector3& gravity,
           double time_step, ThreadTeam* team);

  [[nodiscard]] std::size_t object() const { return object_; }
  [[nodiscard]] FingerSimulation& simulation() { return simulation_; }
  [[nodiscard]] const FingerSimulation& simulation() const { return simulation_; }
  /// As it is at the start of a step; see renew_surface().
  [[nodiscard]] const DeformingSurface& surface() const { return surface_; }

  /// As the scene has it at the start.
  void reset();
  /// The surface is where the nodes are.
  void renew_surface() { surface_.put(simulation_.positions()); }
  void begin_step(double time);
  /// Where its nodes are is where they rest from.
  void mark() { marks_.assign(simulation_.positions().begin(), simulation_.positions().end()); }
  /// Way of the node that is furthest from its mark, m.
  [[nodiscard]] double way() const;
  /// Of the fastest node, m/s.
  [[nodiscard]] double speed() const;
  /// Its pose is that of the rigid motion which brings its nodes at rest nearest to where they are,
  /// weighted by mass (Mueller et al., "Meshless deformations based on shape matching", 2005).
  [[nodiscard]] ObjectState state() const;

 private:
  const Trajectory* motion_;
  std::size_t object_;
  FingerSimulation simulation_;
  DeformingSurface surface_;
  Vector3 centre_O_ = Vector3::Zero();  ///< of mass at rest
  double mass_ = 0.0;
  std::vector<Vector3> marks_;  ///< by node, W
};

}  // namespace softfinger
