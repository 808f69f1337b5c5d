#pragma once

#include <Eigen/Cholesky>
#include <optional>
#include <span>
#include <vector>

#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/numerics/newton.hpp"
#include "softfinger/threads/thread_team.hpp"
#include "softfinger/world/body_motion.hpp"
#include "softfinger/world/body_pull.hpp"
#include "softfinger/world/body_tree.hpp"
#include "softfinger/world/joint_law.hpp"
#include "softfinger/world/soft_contact.hpp"
#include "softfinger/world/solid_contact.hpp"

namespace softfinger {

/// One step of objects that move and of the fingers that may touch them, as one potential: that of
/// each finger, inertia, weight and joints of each body, and contact between objects. It is a
/// problem for minimise_in_cone(). Soft objects are fingers without a hand here.
///
/// The matrix is an arrowhead: each finger's factor A_f with its contact blocks held, columns B_f
/// by the coordinates of the bodies it touches, and the bodies' own D. With Z_f = A_f^-1 B_f the
/// bodies move by S xi = -g + sum B_f^T A_f^-1 g_f, S = D - sum B_f^T Z_f, and each finger by d_f =
/// -A_f^-1 g_f - Z_f xi. Contact with soft objects is in none of these, see SoftContact: with H for
/// the whole of the arrowhead, it takes W = G H^-1 G^T.
class WorldProblem {
 public:
  WorldProblem(const BodyTree& tree, std::span<BodyMotion> motions, SolidContact& contact,
               const Vector3& gravity, double time_step, ThreadTeam* team);
  /// Reserves memory for one more finger, or the scene's soft object of this number; to be called
  /// for each that begin() may name.
  void reserve(FingerSimulation& finger, int object = -1);

  /// Objects stand at X_WO, bodies among them at `places`, from where minimisation starts at the
  /// end of the step, `time` (s). Fingers have begun theirs; spans must outlive the step.
  void begin(double time, std::span<Pose> X_WO, std::span<const BodyPlace> places,
             std::span<FingerSimulation* const> fingers);
  [[nodiscard]] std::span<const BodyPlace> places() const { return current_.places; }
  /// The step has ended where it stands: dry friction of joints follows.
  void end();
  /// Joints as at the start.
  void reset();
  /// Null: the body has neither slider nor hinge.
  [[nodiscard]] const JointLaw* law(std::size_t body) const {
    return joints_[body] ? &joints_[body]->law : nullptr;
  }
  /// Where friction holds the joint of a body; 0 without.
  [[nodiscard]] double anchor(std::size_t body) const {
    return joints_[body] ? joints_[body]->anchor : 0.0;
  }
  /// Where body `b`, a bone of a hand, is tracked at the end of the next step.
  void follow(std::size_t b, const Pose& X_WT) { pulls_[b]->pull.follow(X_WT); }
  /// A person holds body `b`, no bone, by a spring to X_WT at the end of the next step; null:
  /// nobody does.
  void hold(std::size_t b, const Pose* X_WT);
  [[nodiscard]] bool is_held(std::size_t b) const { return holds_[b] && holds_[b]->present; }
  /// It appears there, at rest, or where not `present` it is nowhere and takes no part.
  void put(std::size_t b, const Pose& X_WT, bool present);
  /// Forgets factors.
  void forget();
  [[nodiscard]] bool is_present(std::size_t b) const { return pulls_[b]->present; }
  template <typename Hash>
  void add_to(Hash& hash) const {
    for (const std::optional<Pulled>& pulled : pulls_) {
      if (!pulled) continue;
      hash.add(pulled->present ? 1 : 0);
      pulled->pull.add_to(hash);
    }
    for (const std::optional<Pulled>& held : holds_) {
      if (held && held->present) held->pull.add_to(hash);
    }
  }

  // What minimise_in_cone() asks for.
  [[nodiscard]] double energy() const { return current_.energy; }
  [[nodiscard]] double residual() const { return current_.residual; }
  [[nodiscard]] bool has_factor() const;
  [[nodiscard]] bool factorise(HessianKind kind);
  double solve_direction(bool refined);
  void evaluate_trial(double t);
  [[nodiscard]] double trial_energy() const { return trial_.energy; }
  [[nodiscard]] double trial_residual() const { return trial_.residual; }
  void accept_trial();
  void settle();
  void renew();
  [[nodiscard]] bool is_tangled() const;
  void limit_strain(bool limited);
  [[nodiscard]] bool is_in_cone() const;
  void update_limits(bool only_lower);

 private:
  struct Point {
    std::vector<BodyPlace> places;
    Eigen::VectorXd gradient;
    double energy = 0.0, residual = 0.0;
  };
  /// How a finger and the bodies that it touches depend on each other.
  struct Partner {
    FingerSimulation* finger = nullptr;
    std::size_t number = 0;  ///< as reserved
    std::vector<ObstacleCoupling> couplings;
    std::vector<std::size_t> bodies;  ///< of the couplings in use
    std::vector<Matrix6> yielding;    ///< -B^T A^-1 B of each pair of couplings, as factored
    std::vector<Vector3> carried;     ///< by contact point, N
    bool taking_part = false;
    void find_yielding();
  };
  /// What acts on the coordinate of a slider or hinge.
  struct JointForces {
    JointLaw law;
    double damping = 0.0;  ///< N s/m or N m s/rad
    double anchor = 0.0;   ///< q where dry friction holds
    double old_q = 0.0;    ///< at the start of the step
  };
  /// A bone of a hand, or what a person holds.
  struct Pulled {
    BodyPull pull;
    bool present = true;
  };
  [[nodiscard]] bool is_nowhere(std::size_t body) const {
    return pulls_[body] && !pulls_[body]->present;
  }
  /// Null: nothing pulls.
  [[nodiscard]] const BodyPull* pull_on(std::size_t body) const {
    if (pulls_[body]) return &pulls_[body]->pull;
    return is_held(body) ? &holds_[body]->pull : nullptr;
  }
  [[nodiscard]] LawValue joint_value(const JointForces& joint, double q) const;
  template <typename Work>
  void for_each_finger(const Work& work);
  using At = FingerPotential::At;
  void evaluate_fingers(At at);
  void show(std::span<const BodyPlace> places);
  /// Of what the fingers have evaluated, and the rest at point.places.
  void evaluate(Point& point);
  void add_bodies(Point& point);
  void build_system();
  void add_pair(std::size_t a, std::size_t b, const Matrix6& block);
  void correct_directions();
  /// The directions with contact of soft surfaces; `factor` is that of the bodies' system.
  void bend_to_soft_contact(const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>& factor, bool refined);
  [[nodiscard]] Vector6 twist_of(std::size_t body) const;

  const BodyTree& tree_;
  std::span<BodyMotion> motions_;
  SolidContact& contact_;
  SoftContact soft_;
  Vector3 gravity_;
  double time_step_;
  ThreadTeam* team_;
  std::vector<std::optional<JointForces>> joints_;  ///< by body
  std::vector<std::optional<Pulled>> pulls_;        ///< likewise, of bones
  std::vector<std::optional<Pulled>> holds_;        ///< likewise, of others
  std::vector<Partner> partners_;
  std::vector<std::uint8_t> taking_part_;  ///< by partner
  std::vector<Partner*> fingers_;          ///< that take part
  double time_ = 0.0;
  std::span<Pose> X_WO_;
  std::vector<Vector6> wrenches_;           ///< by object
  std::vector<BodyTree::Columns> columns_;  ///< by body, as last evaluated
  std::vector<double> lengths_;             ///< by coordinate, that moments are measured at, m
  std::vector<double> reaches_;             ///< by body, of its surface from O's origin, m
  Point current_, trial_;
  std::vector<BodyPlace> expected_;
  Eigen::MatrixXd system_;
  Eigen::MatrixXd pulled_, yielding_;  ///< pairs of soft contact by coordinates, and their motion
  Eigen::VectorXd direction_, recoil_;
  bool cache_is_current_ = false;
  bool has_factor_ = false;
};

template <typename Work>
void WorldProblem::for_each_finger(const Work& work) {
  if (team_ != nullptr) {
    team_->run(fingers_.size(), [&](std::size_t f, int) { work(*fingers_[f]); });
  } else {
    for (Partner* partner : fingers_) work(*partner);
  }
}

}  // namespace softfinger
