#pragma once

#include <span>
#include <vector>

#include "softfinger/contact/contact_potential.hpp"
#include "softfinger/fem/elastic_model.hpp"
#include "softfinger/fem/stiffness_assembly.hpp"
#include "softfinger/finger/bone.hpp"
#include "softfinger/finger/contact_correction.hpp"
#include "softfinger/finger/feature_points.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/finger/obstacle_coupling.hpp"
#include "softfinger/numerics/newton.hpp"

namespace softfinger {

/// Contact as stiff as the tissue's modulus asks.
[[nodiscard]] ContactPotential::Options contact_options(const FingerModel& model);

/// The smooth potential whose minimum is one implicit Euler step, or with time step 0 an
/// equilibrium: inertia + elasticity + strain limits + contact + friction + bone + virtual coupling
/// over the free nodes and the bone's pose (Martin et al., "Example-based elastic materials", TOG
/// 2011, for steps as minimisation). It is the problem that numerics/newton.hpp minimises.
/// All memory is reserved by the constructor.
class FingerPotential {
 public:
  enum class Bone {
    kCoupled,     ///< the bone's pose is unknown and tied to the tracked pose by the coupling
    kPrescribed,  ///< the bone is where it is put
  };
  struct Options {
    bool strain_limits = true;
    InstructionSet instruction_set = active_instruction_set();
    ThreadTeam* team = nullptr;  ///< shares the work of large meshes; must outlive the potential
    Vector3 gravity = Vector3::Zero();  ///< on free nodes, W, m/s^2
  };
  /// One step to minimise. Spans must outlive it.
  struct Step {
    double time_step = 0.0;                  ///< s; 0: quasi-static (bone prescribed)
    std::span<const Vector3> old_positions;  ///< all nodes, W, m
    /// Where features of obstacles are looked for, W, m; empty: where even motion leads.
    std::span<const Vector3> seen_positions;
    bool features_given = false;  ///< as restored last, with what they met; none are looked for
    std::span<const Vector3> velocities;  ///< all nodes, W, m/s
    BoneState old_bone;
    Pose X_WFt_old;  ///< tracked pose of the step before; unused where prescribed
    Pose X_WFt;      ///< tracked pose, or the prescribed one
    std::span<const Obstacle> obstacles;
    std::span<FrictionAnchor> anchors;  ///< as ContactPotential::no_anchors(); features' are moved
    const StressHistory* history = nullptr;  ///< of the skin; null: has none
    double elapsed = 0.0;  ///< s that stress had to relax; with time step 0, else it is that
    bool relaxed = false;  ///< all that can relax has; with time step 0
  };

  FingerPotential(const FingerModel& model, Bone bone, std::size_t obstacle_count,
                  const Options& options);

  void begin(const Step& step);
  /// Evaluates at these node positions (tied nodes are put by the bone's pose).
  void start_from(std::span<const Vector3> positions, const Pose& X_WF);
  /// Evaluates at the inertial prediction x + dt v.
  void start_from_prediction();
  /// Nothing touches any more.
  void forget_features() { features_.clear(); }
  /// The feature points are part of the state between steps.
  void keep_features(FeaturePoints::State& state) const { features_.keep(state); }
  void restore_features(const FeaturePoints::State& state) {
    if (!features_.restore(state)) has_factor_ = false;
  }
  /// Evaluates the current point anew where skin and tissue are as before: the anchors or the
  /// features have changed.
  void renew();
  /// Forgets the factor and the warm starts: the next minimisation does not depend on earlier ones.
  void forget();
  /// Forgets the warm starts of contact alone: obstacles may be others, or have jumped.
  void forget_sightings() { contact_.forget(); }
  /// Leaves the strain limits out, or in again, and evaluates the current point anew.
  void limit_strain(bool limited);
  /// Friction limits of the step's anchors from the normal forces last evaluated.
  void update_limits(bool only_lower, double overshoot = ContactPotential::kOvershoot) {
    contact_.update_limits(step_.anchors, only_lower, overshoot);
  }
  /// Whether an element is inside out at the last evaluation.
  [[nodiscard]] bool is_tangled() const;
  /// Makes what is cached (stretches, contact) that of the current point.
  void settle();

  // What minimise() asks for.
  [[nodiscard]] double energy() const { return current_.energy; }
  [[nodiscard]] double residual() const { return current_.residual; }
  [[nodiscard]] bool has_factor() const { return has_factor_ && !correction_.is_full(); }
  [[nodiscard]] bool factorise(HessianKind kind);
  /// `refined`: with contact as it will be at the end of the direction.
  double solve_direction(bool refined);
  void evaluate_trial(double t) {
    put_trial(t);
    meet(At::kTrial);
    complete(At::kTrial);
  }
  /// x = A^-1 x with the factor at hand, by unknowns as gradient(); exact right after factorise().
  void solve(std::span<double> x) const { assembly_.solve(x, team_); }
  void solve_together(std::span<const std::span<double>> xs) const {
    assembly_.solve_together(xs, team_);
  }
  // What the step of a world asks for besides, where poses of obstacles are unknowns as well, or
  // their nodes: an evaluation in parts, between which others' nodes are put and forces on patches
  // handed over.
  enum class At { kCurrent, kTrial };
  void put_trial(double t);
  [[nodiscard]] std::span<const Vector3> positions(At at) const { return point(at).positions; }
  /// First contact, then, with loads(), the rest.
  void meet(At at);
  void complete(At at);
  /// What others press on nodes, N: added to the forces of complete(), from then on. Empty where
  /// the bone is coupled: a finger's surface is not touched by samples of others.
  [[nodiscard]] std::span<Vector3> loads() { return loads_; }
  /// B += weight * load, by the unknowns of a node; lever arms are those of the factor.
  void add_load(int node, const Vector3& load, std::span<double> unknowns) const;
  /// How a node moves in the direction `unknowns`.
  [[nodiscard]] Vector3 motion(int node, std::span<const double> unknowns) const;
  /// d -= x
  void step_back(std::span<const double> x);
  /// The obstacle's pose has been changed in place; what was evaluated is out of date.
  void follow_obstacle(std::size_t o) { contact_.follow(o); }
  [[nodiscard]] ObstacleCoupling make_coupling() const;
  /// How the finger, as just factored, and obstacle o depend on each other.
  void couple(std::size_t o, HessianKind kind, ObstacleCoupling& coupling) const;
  /// d = -A^-1 g.
  void solve_alone();
  /// d -= A^-1 B xi for an obstacle that moves by xi (translation, rotation), as coupled.
  void yield_to(const ObstacleCoupling& coupling, const Vector6& xi);
  /// The direction as solve_direction() refines it, in two parts: the first where the obstacles
  /// are, the second where they will be.
  void start_correction();
  void correct_direction(std::span<const Vector3> carried, double way);
  [[nodiscard]] std::span<const double> direction() const { return direction_; }
  /// g . d
  [[nodiscard]] double slope() const;
  [[nodiscard]] bool is_in_cone() const { return contact_.is_in_cone(); }

  [[nodiscard]] double trial_energy() const { return trial_.energy; }
  [[nodiscard]] double trial_residual() const { return trial_.residual; }
  void accept_trial() {
    std::swap(current_, trial_);
    cache_is_current_ = true;
  }

  [[nodiscard]] std::span<const Vector3> positions() const { return current_.positions; }
  [[nodiscard]] const Pose& bone_pose() const { return current_.X_WF; }
  /// Derivative by each unknown: free nodes, then translation (N) and rotation (N m) of the bone.
  [[nodiscard]] std::span<const double> gradient() const { return current_.gradient; }
  [[nodiscard]] double elastic_energy() const { return current_.elastic_energy; }
  [[nodiscard]] const UnknownMap& unknowns() const { return map_; }
  [[nodiscard]] const ElasticModel& elastic() const { return elastic_; }
  [[nodiscard]] const ElasticModel::Work& elastic_work() const { return work_; }
  [[nodiscard]] const ContactPotential& contact() const { return contact_; }
  [[nodiscard]] const FeaturePoints& features() const { return features_; }
  /// Positions of the skin samples, and after them of the feature points, at the last evaluation,
  /// W.
  [[nodiscard]] std::span<const Vector3> contact_positions() const {
    return {contact_positions_.data(), contact_points()};
  }
  /// Largest absolute component of the gradient on a free node, N.
  [[nodiscard]] double largest_free_force() const;

 private:
  struct Point {
    std::vector<Vector3> positions;
    Pose X_WF;
    double energy = 0.0, elastic_energy = 0.0, contact_energy = 0.0, residual = 0.0;
    std::vector<double> gradient;
    Matrix3 moments = Matrix3::Zero();  ///< sum over tied nodes of gradient times r^T
  };
  [[nodiscard]] Point& point(At at) { return at == At::kTrial ? trial_ : current_; }
  [[nodiscard]] const Point& point(At at) const { return at == At::kTrial ? trial_ : current_; }
  void evaluate_current() {
    meet(At::kCurrent);
    complete(At::kCurrent);
  }
  /// What complete() does after the tissue's forces are known.
  void add_up(At at);
  void choose_features();
  [[nodiscard]] std::size_t contact_points() const {
    return model_.sample_nodes.size() + features_.points().size();
  }
  void put_contact_points(std::span<const Vector3> nodes);
  void put_tied_nodes(Point& point) const;
  void reduce_gradient(Point& point, double& squared_norm) const;
  void apply_correction();
  /// Adds a load at a contact point, by each of six columns, where the node carries this part of
  /// it.
  void add_loads(int node, double weight, const Matrix36& by_point,
                 std::array<std::vector<double>, 6>& columns) const;

  const FingerModel& model_;
  Vector3 gravity_;
  Bone bone_mode_;
  UnknownMap map_;
  ElasticModel elastic_;
  ThreadTeam* team_;  ///< null: nothing is shared
  StiffnessAssembly assembly_;
  BonePotential bone_;
  ContactPotential contact_;
  ContactCorrection correction_;
  FeaturePoints features_;
  std::vector<Vector3> starts_;  ///< of the samples, W, m
  Step step_;

  Point current_, trial_;
  bool cache_is_current_ = false;
  bool has_factor_ = false;
  ElasticModel::Work work_;
  std::vector<double> direction_;
  std::vector<Vector3> predicted_;
  std::vector<Vector3> elastic_gradient_;  ///< by nodes, at the last evaluation
  std::vector<Vector3> node_gradient_;
  std::vector<Vector3> loads_;
  std::vector<Vector3> contact_positions_, contact_gradient_;
  std::vector<Matrix3> contact_blocks_;
  std::vector<Vector3> lever_arms_;
};

}  // namespace softfinger
