#pragma once

#include <optional>
#include <span>
#include <vector>

#include "softfinger/world/body_motion.hpp"
#include "softfinger/world/body_pull.hpp"
#include "softfinger/world/body_tree.hpp"
#include "softfinger/world/joint_law.hpp"

namespace softfinger {

/// What acts on each body by itself in a step: weight, the law, damping and friction of its joint,
/// and what pulls it, for it is a bone of a hand or a person holds it.
class BodyForces {
 public:
  /// `tree` must outlive it. gravity in m/s^2, W; time_step in s. Throws InputError where a force
  /// curve falls too steeply for the step.
  BodyForces(const BodyTree& tree, const Vector3& gravity, double time_step);

  /// Null: the body has neither slider nor hinge.
  [[nodiscard]] const JointLaw* law(std::size_t b) const {
    return joints_[b] ? &joints_[b]->law : nullptr;
  }
  /// Of the joint's coordinate q, with damping and friction; the body has a law.
  [[nodiscard]] LawValue joint(std::size_t b, double q) const;

  [[nodiscard]] bool is_bone(std::size_t b) const { return pulls_[b].has_value(); }
  /// Where a bone of a hand is tracked at the end of the next step.
  void follow(std::size_t b, const Pose& X_WT) { pulls_[b]->pull.follow(X_WT); }
  /// A bone appears there, at rest, or where not `present` it is nowhere and takes no part.
  void put(std::size_t b, const Pose& X_WT, bool present);
  [[nodiscard]] bool is_nowhere(std::size_t b) const { return pulls_[b] && !pulls_[b]->present; }
  /// A person holds what is no bone, and stands at X_WO, by a spring to X_WT at the end of the next
  /// step; null: nobody does.
  void hold(std::size_t b, const Pose& X_WO, const Pose* X_WT);
  [[nodiscard]] bool is_held(std::size_t b) const { return holds_[b] && holds_[b]->present; }
  /// Null: nothing pulls.
  [[nodiscard]] const BodyPull* pull_on(std::size_t b) const;

  /// What its weight would do by itself, m/s^2: a hand bears itself.
  [[nodiscard]] Vector3 gravity(std::size_t b) const {
    return is_bone(b) ? Vector3(Vector3::Zero()) : gravity_;
  }
  /// That moments about a coordinate are measured at, m.
  [[nodiscard]] double length(int coordinate) const {
    return lengths_[static_cast<std::size_t>(coordinate)];
  }
  /// Of the body's surface from O's origin, m.
  [[nodiscard]] double reach(std::size_t b) const { return reaches_[b]; }

  /// A step begins with the body there, and has ended there: dry friction of joints follows.
  void begin(std::size_t b, const BodyPlace& place);
  void end(std::size_t b, const BodyPlace& place);
  /// As at the start.
  void reset();
  template <typename Hash>
  void add_to(Hash& hash, std::size_t b) const {
    if (joints_[b]) hash.add(joints_[b]->anchor);
    if (pulls_[b]) hash.add(pulls_[b]->present ? 1 : 0);
    if (const BodyPull* const pull = pull_on(b)) pull->add_to(hash);
  }

 private:
  /// What acts on the coordinate of a slider or hinge.
  struct JointForces {
    JointLaw law;
    double damping = 0.0;  ///< N s/m or N m s/rad
    double anchor = 0.0;   ///< q where dry friction holds
    double old_q = 0.0;    ///< at the start of the step
  };
  struct Pulled {
    BodyPull pull;
    bool present = true;
  };

  const BodyTree& tree_;
  Vector3 gravity_;
  double time_step_;
  std::vector<double> lengths_;  ///< by coordinate
  std::vector<double> reaches_;  ///< by body, as all that follows
  std::vector<std::optional<JointForces>> joints_;
  std::vector<std::optional<Pulled>> pulls_, holds_;  ///< of bones, of others
};

}  // namespace softfinger
