#pragma once

#include <Eigen/SparseCholesky>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "plain_elasticity.hpp"
#include "softfinger/contact/contact_potential.hpp"
#include "softfinger/finger/bone.hpp"
#include "softfinger/finger/finger_simulation.hpp"

namespace softfinger {

/// One implicit Euler step as one would write it first; what FingerSimulation is measured against.
///
/// The same potential and the same tolerance: elasticity, strain limits, contact, friction within
/// its cone, bone and coupling. Minimised by projected Newton: every element's Hessian made
/// positive semidefinite, a sparse matrix of triplets factored anew in each iteration, and a line
/// search on the energy. It meets obstacles at the samples only. The contact potential and the
/// bone's terms are the library's; elasticity and solver are not.
class PlainStep {
 public:
  /// `objects` must outlive it.
  PlainStep(std::shared_ptr<const FingerModel> model, std::span<const VirtualObject> objects,
            double time_step);

  void reset(const Pose& X_WFt);
  /// Minimises the step that ends at `time` (s) with the tracked finger at X_WFt; the step is not
  /// taken before advance().
  StepSummary solve(const Pose& X_WFt, double time);
  /// Goes on to a hundredth of the tolerance, for comparisons, with the limits of friction that
  /// solve() found. Returns whether it got there.
  bool refine();
  /// Positions of all nodes that solve() or refine() found, W, m.
  [[nodiscard]] std::span<const Vector3> positions() const { return current_.positions; }
  /// Relative residual, after solve(), of another answer to the same step.
  [[nodiscard]] double residual_at(std::span<const Vector3> positions, const Pose& X_WF);
  /// Takes the step to these positions of all nodes and the bone, wherever they come from.
  void advance(std::span<const Vector3> positions, const Pose& X_WF, const Pose& X_WFt,
               double time);

 private:
  struct Point {
    std::vector<Vector3> positions;
    Pose X_WF;
    double energy = 0.0, residual = 0.0;
    Eigen::VectorXd gradient;
  };
  /// How a node moves with three unknowns from `first` on.
  struct Motion {
    int first = 0;
    Matrix3 by_unknowns = Matrix3::Identity();
  };
  struct NodeMotion {
    std::array<Motion, 2> parts;
    std::size_t count = 0;
    [[nodiscard]] std::span<const Motion> all() const { return {parts.data(), count}; }
  };
  void note_starts();
  void place_obstacles(double time);
  void put_tied_nodes(Point& point) const;
  [[nodiscard]] NodeMotion motion(std::size_t node, const Point& point) const;
  void read_samples(const Point& point);
  void evaluate(Point& point);
  void add_block(const NodeMotion& a, const NodeMotion& b, const Matrix3& block);
  void add_block(int row, int column, const Matrix3& block);
  void assemble();
  StepSummary minimise(double tolerance);
  StepSummary minimise_in_cone();
  [[nodiscard]] bool line_search(const Eigen::VectorXd& direction);

  std::shared_ptr<const FingerModel> model_;
  std::span<const VirtualObject> objects_;
  double time_step_;
  PlainElasticity elasticity_;
  BonePotential bone_potential_;
  ContactPotential contact_;
  std::vector<int> first_unknown_;  ///< per node, -1: tied
  int unknowns_ = 0;                ///< the bone's are the last six

  // State between steps.
  std::vector<Vector3> positions_, velocities_;
  BoneState bone_;
  Pose tracked_;
  std::vector<FrictionAnchor> anchors_;

  std::vector<FrictionAnchor> limited_;  ///< with the limits of the step that is solved

  std::vector<Obstacle> obstacles_;
  std::vector<Vector3> predicted_;
  Point current_, trial_;
  std::vector<Vector3> node_gradient_, sample_positions_, sample_gradient_;
  std::vector<Vector3> starts_;  ///< of the samples
  std::vector<Eigen::Triplet<double>> triplets_;
};

}  // namespace softfinger
