#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/device/kinematics.hpp"
#include "softfinger/device/mechanism/closed_linkage.hpp"
#include "softfinger/device/mechanism/solved_grid.hpp"
#include "softfinger/device/surfaces/surface_piece.hpp"
#include "softfinger/numerics/small_lu.hpp"

namespace softfinger {

/// What a mechanism's file describes, beside what every device has.
struct MechanismDescription {
  ClosedLinkage linkage;
  LinkageCoordinates home;                    ///< of the linkage, closed, at the device's home
  std::vector<LinkageReading> configuration;  ///< q, one an axis
  std::vector<LinkageReading> joints;         ///< of the actuated ones, in their order
  std::vector<SurfacePiece> surface;          ///< 1 to kMaxSurfacePieces
  /// The body whose z axis may lean away from where it points at `upright` by max_tilt.
  struct TiltLimit {
    int body = 0;
    Matrix3 upright = Matrix3::Identity();
    double max_tilt = 0.0;  ///< rad
  };
  std::optional<TiltLimit> tilt;
  int approach_axis = -1;
};

/// Any linkage of rigid bodies, with loops or without, that touches the finger with pieces of
/// surface on its bodies. q are readings of it that determine it near home; they are solved for by
/// Newton's method from solutions on a grid around home, always on the branch of home, so that the
/// answer depends on q alone. Derivatives by the implicit function theorem.
///
/// The workspace is what straight lines in q reach from home, or steps of the grid do, with loops
/// closed, joints and tilt within limits and neither determinant changing its sign: that of the
/// equations that give the joints from q, and that of d(joints)/dq. Where the loops do not close,
/// the surface goes on straight from the last q where they do.
class Mechanism final : public Kinematics {
 public:
  /// The settings' axes and joint limits are set.
  Mechanism(const DeviceSettings& settings, MechanismDescription description);

  [[nodiscard]] const MechanismDescription& description() const { return description_; }

  /// All of the linkage at q; false where its loops do not close, it is then gone on straight. Each
  /// thread remembers the last answer.
  [[nodiscard]] bool solve(const Configuration& q, LinkageSolution& solution) const;
  /// det d(joints)/dq over its value at home; 0 at a type-2 singularity.
  [[nodiscard]] double singularity_ratio(const LinkageSolution& solution) const;
  /// That determinant at home, in units of the linkage's length: near 0, home is singular.
  [[nodiscard]] double scaled_home_determinant() const;
  /// How far the limited body leans, rad; 0 where none is limited.
  [[nodiscard]] double tilt(const LinkageSolution& solution) const;

  [[nodiscard]] bool inverse_kinematics(const Configuration& q, JointAngles& joints) const override;
  void clamped_joints(const Configuration& q, JointAngles& joints) const override;
  [[nodiscard]] bool forward_kinematics(const JointAngles& joints, Configuration& q) const override;
  [[nodiscard]] bool reachable(const Configuration& q) const override;

  [[nodiscard]] int constraint_count() const override;
  [[nodiscard]] bool constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                                 Eigen::Ref<Eigen::MatrixXd> jacobian) const override;
  void add_constraint_curvature(const Configuration& q,
                                const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                Eigen::Ref<Eigen::MatrixXd> hessian) const override;
  [[nodiscard]] std::span<const std::string> constraint_names(int k) const override;

  [[nodiscard]] Configuration facing(const Vector3& normal_F,
                                     const Configuration& q) const override;
  [[nodiscard]] int approach_axis() const override { return description_.approach_axis; }
  /// Of the body that carries the first piece.
  [[nodiscard]] Pose pose(const Configuration& q) const override;
  /// Of that body, for up to three degrees of freedom; without second derivatives.
  [[nodiscard]] RigidMotion motion(const Configuration& q) const override;
  void place(const Configuration& q, std::span<Pose> bodies) const override;
  [[nodiscard]] BodyTwist twist(const Configuration& q, int body) const override;
  void add_motion_curvature(const Configuration& q, std::span<const BodyLoad> loads,
                            Eigen::Ref<Eigen::MatrixXd> hessian) const override;
  [[nodiscard]] int leg_count() const override { return static_cast<int>(legs_.size()); }
  void linkage(const Configuration& q, std::span<Vector3> points_F) const override;

 private:
  [[nodiscard]] std::unique_ptr<Kinematics> copy() const override {
    return std::make_unique<Mechanism>(*this);
  }
  /// A point of a body, for drawings.
  struct BodyPoint {
    int body;
    Vector3 point;  ///< in the body
  };
  using Leg = std::array<BodyPoint, 3>;
  // Constraints: joints above max, joints below min, stretched, singular, and tilt where limited.
  enum class Constraint { kAbove, kBelow, kStretched, kSingular, kTilt };

  [[nodiscard]] int joints() const { return static_cast<int>(description_.joints.size()); }
  [[nodiscard]] int constraint(Constraint kind, int joint = 0) const;
  [[nodiscard]] double joint_value(const LinkageSolution& solution, int joint) const;
  [[nodiscard]] double joint_scale(int joint) const;
  void fill_joints(const LinkageSolution& solution, JointAngles& joints) const;
  [[nodiscard]] bool within_limits(const LinkageSolution& solution) const;
  [[nodiscard]] double stretch_ratio(const LinkageSolution& solution) const;
  [[nodiscard]] SolvedGrid explored() const;
  /// Where it tilts both ways and travels.
  [[nodiscard]] std::optional<PlatformSpace> platform_space() const override;
  /// How far each axis goes with the others at home.
  [[nodiscard]] std::vector<AxisReach> reaches() const override;
  void name_constraints();
  void find_legs();
  /// Legs of two links each from the base, or the first link drawn already, to a point of a body.
  void add_chain(const BodyPoint& end, std::vector<bool>& drawn);

  // Motion of everything at rate 1 of axis l, and how the derivatives of those equations change
  // with it whose weight is not 0.
  void axis_motion(const LinkageSolution& solution, int l, const LinkageCoordinates& weights,
                   LinkageVelocity& velocity, LinkageMatrix& rates) const;
  [[nodiscard]] BodyTwist twist(const LinkageSolution& solution, int body) const;

  struct Solved {
    std::uint64_t mechanism = 0;
    LinkageInputs q;
    bool closed = false;
    LinkageSolution solution;
  };
  /// What solve() gives, as this thread remembers it until it asks for another.
  [[nodiscard]] const Solved& solved(const Configuration& q) const;
  [[nodiscard]] bool solve_afresh(const LinkageInputs& wanted, LinkageSolution& solution) const;

  std::uint64_t number_;  ///< of this and the same mounted elsewhere: what is solved is in B'
  MechanismDescription description_;
  LinkageSolution home_solution_;
  double home_determinant_ = 0.0;  ///< of d(joints)/dq
  std::vector<Leg> legs_;
  std::vector<std::vector<std::string>> constraint_names_;
  SolvedGrid grid_;
};

}  // namespace softfinger
