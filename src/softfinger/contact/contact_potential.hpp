#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "softfinger/contact/contact_side.hpp"
#include "softfinger/geometry/signed_distance.hpp"

namespace softfinger {

/// Where a sample may meet a surface that deforms: there it counts as flat, and it moves with the
/// surface. Its frame P has its origin on the surface and z out of it.
struct SurfacePatch {
  bool near = false;  ///< else the sample cannot meet it, and nothing else holds
  Pose X_WP, X_PW;
  void put(const Pose& pose) {
    X_WP = pose;
    X_PW = pose.inverse();
  }
};

/// A solid the skin may touch, where it is at the end of the step.
struct Obstacle {
  const Shape* shape = nullptr;  ///< a half-space where it has patches
  Pose X_WO;
  double friction_coefficient = 0.0;
  std::optional<Pose> X_WO_old;  ///< where it was at the start of the step; absent: where it is
  bool moves = false;            ///< X_WO is an unknown of the step, see ContactPotential::follow()
  /// A soft obstacle has no frame O: each sample meets it as a patch of its own, and in that
  /// frame. Feature points do not meet it. One a sample; a rigid obstacle has none.
  std::span<const SurfacePatch> patches;
  bool is_soft = false;
};

/// An obstacle as one point of the skin meets it: gap = normal . p + offset, in W, m.
struct ContactPlane {
  int obstacle = -1;
  Vector3 normal = Vector3::UnitZ();
  double offset = 0.0;
};

/// Memory of one sample sticking to or sliding on one obstacle, in the obstacle's frame O.
struct FrictionAnchor {
  Vector3 anchor_O = Vector3::Zero();
  Vector3 normal_O = Vector3::UnitZ();
  double limit = 0.0;  ///< greatest tangential force, N; 0: no contact at the end of the last step
  /// Where a sample touched at the end of the last step; unknown where it was clear, and of points
  /// that are no samples.
  ContactSide side;
};

/// Potential energy of points of the skin against obstacles, all in W: the samples, and after them
/// as many points as the caller has at a time that each meet one obstacle, as a plane. Pairs of a
/// point and an obstacle whose box it is outside of, and no friction ties it to, are passed over:
/// they add nothing, so results do not depend on it.
///
/// A sample is pushed out on the side it came from: the one it touched at the end of the last step,
/// else the one that its way in this step goes in by. See distance_from_side().
///
/// Normal contact is a stiff penalty, 1/2 k gap^2 for gap < 0, with k proportional to the point's
/// area. Tangential contact is Coulomb friction as a Huber potential of the displacement u from an
/// anchor: 1/2 kt |u|^2 up to the limit force mu f_n, linear beyond; f_n and the normal are those
/// at the end of the last step, and a sliding anchor follows so that kt |u| = mu f_n (after the
/// sliding anchors of Verschoor, Lobo, Otaduy, "Soft hand simulation for smooth and robust natural
/// interaction", IEEE VR 2018).
class ContactPotential {
 public:
  struct Options {
    double stiffness_per_area = 1e10;  ///< N/m^3
    double tangential_ratio = 0.02;    ///< kt / k
  };
  /// rest_areas: one per point that there can be, m^2; the first `samples` of them meet all
  /// obstacles.
  ContactPotential(std::vector<double> rest_areas, std::size_t samples, std::size_t obstacle_count,
                   Options options);

  /// Anchors, one per point and obstacle (obstacle fastest): the state between steps.
  [[nodiscard]] std::vector<FrictionAnchor> no_anchors() const;

  /// The obstacles and anchors that evaluations see from now on, and where the samples are at the
  /// start of the step (W, m; none: they come from nowhere); all must outlive them. No planes.
  void begin(std::span<const Obstacle> obstacles, std::span<const FrictionAnchor> anchors,
             std::span<const Vector3> starts = {});
  /// One more point, behind the others, which meets this plane; it goes with its obstacle.
  void add_plane(const ContactPlane& plane);
  /// The pose of obstacle o, one that moves, has been changed in place: evaluations see it there.
  void follow(std::size_t o);

  /// Energy with the points at these positions (W, m), J; no more are considered than are given.
  /// Adds the gradient by each to `gradient`, N.
  double energy_gradient(std::span<const Vector3> positions, std::span<Vector3> gradient);
  /// Second derivative by sample i at the positions last evaluated, N/m, without that of soft
  /// obstacles. Returns false if zero.
  bool hessian(std::size_t i, bool with_curvature, Matrix3& block) const;
  /// Gradient (N) and second derivative (N/m) of the energy of sample i alone at `position` (W, m),
  /// without those of soft obstacles.
  struct Response {
    Vector3 gradient = Vector3::Zero();
    Matrix3 hessian = Matrix3::Zero();
  };
  [[nodiscard]] Response respond(std::size_t i, const Vector3& position) const;
  /// Of sample i and the soft obstacle o alone, its patch where it is.
  [[nodiscard]] Response respond_to_patch(std::size_t i, std::size_t o,
                                          const Vector3& position) const;
  /// Gap of sample i to the soft obstacle o as last evaluated, m; infinite without a patch.
  [[nodiscard]] double patch_gap(std::size_t i, std::size_t o) const;
  /// Force of the soft obstacle o on sample i as last evaluated, friction included, N.
  [[nodiscard]] Vector3 patch_force(std::size_t i, std::size_t o) const;
  /// What point i and obstacle o alone do to each other at the positions last evaluated: the force
  /// of normal contact on the skin (N), minus its derivative by the point, and gradient and second
  /// derivative of the pair's energy, friction included.
  struct PairResponse {
    Vector3 normal_force = Vector3::Zero();
    Vector3 outward = Vector3::UnitZ();  ///< the obstacle's gradient there
    Matrix3 normal_stiffness = Matrix3::Zero();
    Vector3 gradient = Vector3::Zero();
    Matrix3 hessian = Matrix3::Zero();
    /// What grows besides, as the point moves against the obstacle, where friction's limit and
    /// plane follow the normal force: part of the gradient's derivative that the energy does not
    /// know, and so not symmetric.
    Matrix3 following = Matrix3::Zero();
  };
  /// False where the pair does nothing. `with_curvature`: of the obstacle, in both derivatives.
  bool pair_response(std::size_t i, std::size_t o, bool with_curvature,
                     PairResponse& response) const;
  /// What all points last evaluated do to obstacle o, one that moves: derivative of the energy by
  /// its translation (N) and by its rotation about O's origin (N m), W. Of one that does not move
  /// nothing but the normal force.
  struct Wrench {
    Vector3 by_translation = Vector3::Zero();
    Vector3 by_rotation = Vector3::Zero();
    double normal_force = 0.0;  ///< sum of magnitudes, N
  };
  [[nodiscard]] const Wrench& wrench(std::size_t o) const { return wrenches_[o]; }
  /// Lower bound of the least gap of sample i at the positions last evaluated, m; exact where it
  /// touches.
  [[nodiscard]] double gap(std::size_t i) const;
  /// Lower bound of the gap of point i to obstacle o at `position_O`, m.
  [[nodiscard]] double gap_bound(std::size_t i, std::size_t o, const Vector3& position_O) const;
  /// Distance and gradient of sample i at `position_O` to obstacle o, from the sample's side.
  [[nodiscard]] SignedDistance look(std::size_t i, std::size_t o, const Vector3& position_O) const;
  /// Where sample i touched obstacle o at the end of the last step.
  [[nodiscard]] const ContactSide& side(std::size_t i, std::size_t o) const {
    return anchors_[i * obstacle_count_ + o].side;
  }
  /// Whether sample i may meet obstacle o at all: not a soft one without a patch.
  [[nodiscard]] bool may_meet(std::size_t i, std::size_t o) const {
    return !obstacles_[o].is_soft ||
           (!obstacles_[o].patches.empty() && obstacles_[o].patches[i].near);
  }
  /// Where W is seen from obstacle o as sample i meets it: at the end of the step.
  [[nodiscard]] const Pose& obstacle_view(std::size_t i, std::size_t o) const {
    return obstacles_[o].is_soft ? obstacles_[o].patches[i].X_PW : X_OW_[o];
  }
  /// The same of a rigid one, at the end of the step and at its start.
  [[nodiscard]] const Pose& obstacle_view(std::size_t o) const { return X_OW_[o]; }
  [[nodiscard]] const Pose& old_obstacle_view(std::size_t o) const { return X_OW_old_[o]; }
  [[nodiscard]] double friction_coefficient(std::size_t o) const {
    return obstacles_[o].friction_coefficient;
  }
  /// Forgets where gaps were looked up: the obstacles have other shapes from now on.
  void forget();
  /// Norm of all contact forces last evaluated, N.
  [[nodiscard]] double force_norm() const { return force_norm_; }

  /// New anchors from the positions last evaluated. Returns the greatest change of any friction
  /// limit, N: how far the lagged normal forces were off.
  double update_anchors(std::span<const Vector3> positions,
                        std::span<FrictionAnchor> anchors) const;
  /// Replaces only the friction limits and normals by those of the positions last evaluated,
  /// keeping where samples stick: one pass of the iteration that removes the lag. `only_lower`:
  /// none rises, so that passes come to an end, and each goes further by this part of its fall:
  /// with less friction the next normal force is mostly lower too. Returns the greatest change.
  double update_limits(std::span<FrictionAnchor> anchors, bool only_lower = false,
                       double overshoot = kOvershoot) const;
  static constexpr double kOvershoot = 0.3;
  /// Sum over all points of the friction last evaluated beyond that cone, N.
  [[nodiscard]] double beyond_cone() const;
  /// Whether the friction last evaluated is within the cone of the normal forces last evaluated:
  /// at every point, to kConeRelative of mu f_n and kConeAbsolute (N).
  [[nodiscard]] bool is_in_cone() const;
  static constexpr double kConeRelative = 1e-2;
  static constexpr double kConeAbsolute = 1e-6;

  /// Of all obstacles on point i as last evaluated, W, N.
  struct Forces {
    Vector3 normal = Vector3::Zero();
    Vector3 tangential = Vector3::Zero();
    double normal_sum = 0.0;      ///< of the magnitudes of normal forces
    double friction_limit = 0.0;  ///< mu times these, summed
    bool slides = false;
  };
  [[nodiscard]] Forces forces(std::size_t i) const;
  /// Gap (m), normal (W, unit) and number of the obstacle nearest to point i as last evaluated.
  struct Nearest {
    double gap = std::numeric_limits<double>::infinity();
    Vector3 normal = Vector3::UnitZ();
    int obstacle = -1;
  };
  [[nodiscard]] bool is_soft(int obstacle) const {
    return obstacle >= 0 && obstacles_[static_cast<std::size_t>(obstacle)].is_soft;
  }
  [[nodiscard]] Nearest nearest(std::size_t i) const;

 private:
  template <typename Visit>
  bool all_that_rub(const Visit& visit) const;
  struct Pair {
    double gap = 0.0;  ///< where `far`, only a lower bound
    Vector3 position_O = Vector3::Zero();
    bool far = false;                     ///< cannot touch: neither gap nor gradient were looked up
    Vector3 gradient = Vector3::UnitZ();  ///< of the gap
    Matrix3 curvature = Matrix3::Zero();  ///< its Hessian, 1/m
    double pressing = 0.0;                ///< k times depth, N: the force over |gradient|
    double friction_limit = 0.0;          ///< N, the anchor's
    Vector3 friction_force = Vector3::Zero();  ///< on the skin
    Vector3 friction_normal = Vector3::UnitZ();
    double slip = 0.0;  ///< |u|, m
    Vector3 slip_direction = Vector3::Zero();
    bool slides = false;  ///< meaningless without a friction limit
    bool behind = false;  ///< the gap is that to the side it came from
    ContactSide entered;  ///< where it went in, if `looked_back`
    bool looked_back = false;
  };
  /// A gap once looked up: no sample touches before it has come that far from there.
  struct Sighting {
    Vector3 position_O = Vector3::Zero();
    double gap = 0.0;
  };
  [[nodiscard]] double normal_stiffness(std::size_t i) const {
    return options_.stiffness_per_area * rest_areas_[i];
  }
  [[nodiscard]] double tangential_stiffness(std::size_t i) const {
    return options_.tangential_ratio * normal_stiffness(i);
  }
  /// X_WO as point i meets obstacle o.
  [[nodiscard]] const Pose& obstacle_pose(std::size_t i, std::size_t o) const {
    return obstacles_[o].is_soft ? obstacles_[o].patches[i].X_WP : obstacles_[o].X_WO;
  }
  [[nodiscard]] double bound_by_sighting(std::size_t i, std::size_t o,
                                         const Vector3& position_O) const;
  /// Whether point i at `position` and any obstacle can do anything to each other.
  [[nodiscard]] bool may_act(std::size_t i, const Vector3& position) const;
  /// Whether point i at `position` and obstacle o can do anything to each other.
  [[nodiscard]] bool may_act(std::size_t i, std::size_t o, const Vector3& position) const;
  /// Whether the way of sample i to `position` comes near the box.
  [[nodiscard]] bool comes_near(const Eigen::AlignedBox3d& box_W, std::size_t i,
                                const Vector3& position) const;
  /// The side that sample i comes from, where that may matter at `position_O` with the signed
  /// distance `at`; unknown where not. Fills `pair` where it had to look back.
  [[nodiscard]] ContactSide side_of(std::size_t i, std::size_t o, const Vector3& position_O,
                                    const SignedDistance& at, Pair& pair) const;
  double evaluate(std::size_t i, std::size_t o, const Vector3& position, Pair& pair) const;
  /// Gap and gradient; false where the two cannot touch.
  bool meet(std::size_t i, std::size_t o, const Vector3& position, Pair& pair) const;
  /// What the pair, as last evaluated, remembers of its side.
  [[nodiscard]] ContactSide side_after(std::size_t i, std::size_t o, const Pair& pair) const;
  double friction(std::size_t i, const Pose& X_WO, const FrictionAnchor& anchor,
                  const Vector3& position, Pair& pair) const;
  /// PairResponse::following.
  [[nodiscard]] Matrix3 following(std::size_t i, std::size_t o, const Pair& pair,
                                  bool with_curvature) const;
  /// Adds the second derivative of one pair; returns false if zero.
  bool add_hessian(std::size_t i, std::size_t o, const Pair& pair, bool with_curvature,
                   Matrix3& block) const;

  std::vector<double> rest_areas_;
  std::size_t samples_ = 0;
  std::size_t obstacle_count_ = 0;
  std::vector<ContactPlane> planes_;
  Options options_;
  std::span<const Obstacle> obstacles_;
  std::span<const FrictionAnchor> anchors_;
  std::span<const Vector3> starts_;
  std::vector<Pose> X_OW_, X_OW_old_;
  std::vector<Wrench> wrenches_;
  std::vector<ContactSide> entered_;          ///< per pair: where it went in during this step
  std::vector<std::uint8_t> looked_back_;     ///< per pair: that is known
  std::vector<Eigen::AlignedBox3d> boxes_O_;  ///< that hold each obstacle
  std::vector<Eigen::AlignedBox3d> boxes_W_;  ///< the same and a little more
  Eigen::AlignedBox3d box_W_;                 ///< about all of these
  std::vector<std::uint8_t> held_;            ///< per pair: friction counts in this step
  std::vector<std::uint8_t> tied_;            ///< per point: held by some obstacle
  std::vector<std::uint8_t> near_;            ///< per pair: evaluated, else passed over
  std::vector<std::uint8_t> is_near_;         ///< per point: not all of its pairs are passed over
  std::vector<Pair> pairs_;                   ///< valid where near
  std::vector<Sighting> sightings_;
  std::vector<Vector3> positions_;  ///< last evaluated
  std::size_t points_ = 0;          ///< last evaluated
  double force_norm_ = 0.0;
};

}  // namespace softfinger
