#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "softfinger/device/device_settings.hpp"
#include "softfinger/device/rigid_motion.hpp"
#include "softfinger/device/workspace.hpp"

namespace softfinger {

/// What moves a contacting surface: configuration q to joints and back, the workspace, and where
/// the bodies are that carry the surface. Immutable and shared by threads. Nothing but the
/// constructors, mounted() and what is for people allocates or throws.
class Kinematics {
 public:
  virtual ~Kinematics() = default;
  Kinematics& operator=(const Kinematics&) = delete;
  /// The same, mounted elsewhere: nothing in B' is computed anew.
  [[nodiscard]] std::unique_ptr<const Kinematics> mounted(const Pose& X_FB) const;

  [[nodiscard]] std::span<const ConfigurationAxis> axes() const { return axes_; }
  [[nodiscard]] int degrees_of_freedom() const { return static_cast<int>(axes_.size()); }
  [[nodiscard]] const Configuration& home() const { return home_; }
  [[nodiscard]] const JointLimits& joint_limits() const { return joint_limits_; }
  /// The mount: neutral frame B' in F.
  [[nodiscard]] const Pose& mount() const { return X_FB_; }

  /// Joint angles of q; false where the linkage does not close (joints are then unspecified).
  /// Joint limits are not looked at.
  [[nodiscard]] virtual bool inverse_kinematics(const Configuration& q,
                                                JointAngles& joints) const = 0;
  /// Joint angles for any q: the nearest that exist, cut to the joint limits. The base class cuts
  /// those of the inverse kinematics.
  virtual void clamped_joints(const Configuration& q, JointAngles& joints) const;
  /// The configuration inside the workspace that has these joint angles; false if there is none.
  [[nodiscard]] virtual bool forward_kinematics(const JointAngles& joints,
                                                Configuration& q) const = 0;
  /// Whether q lies in the workspace (limits count as inside, to 1e-9).
  [[nodiscard]] virtual bool reachable(const Configuration& q) const = 0;

  /// The workspace as inequalities c_k(q) <= 0, scaled to be comparable with metres of surface
  /// motion: joint limits, linkage reach, tilt, distance to singularity.
  [[nodiscard]] virtual int constraint_count() const { return 0; }
  /// values: constraint_count; jacobian: constraint_count x dof. False where they are undefined
  /// (q is then far outside).
  [[nodiscard]] virtual bool constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                                         Eigen::Ref<Eigen::MatrixXd> jacobian) const;
  /// hessian += sum of multiplier_k d2c_k/dq2, for the k with a multiplier above zero. Those of the
  /// base class are straight.
  virtual void add_constraint_curvature(const Configuration& q,
                                        const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                        Eigen::Ref<Eigen::MatrixXd> hessian) const;
  /// Names of what is at its limit where constraint k is active: "joint_1" or axis names.
  [[nodiscard]] virtual std::span<const std::string> constraint_names(int k) const;

  /// q turned so that the surface faces along normal_F (unit, towards the finger) as far as its
  /// limits allow, other axes as they are. Kinds that cannot turn return q.
  [[nodiscard]] virtual Configuration facing(const Vector3& normal_F, const Configuration& q) const;
  /// Axis that moves the surface towards the finger; -1 where there is no single one.
  [[nodiscard]] virtual int approach_axis() const = 0;
  /// Whether advance() moves the surface.
  [[nodiscard]] virtual bool advances() const { return approach_axis() >= 0; }
  /// Moves the whole surface towards the finger by `distance` (m); limits are not looked at.
  virtual void advance(double distance, Configuration& q) const;

  /// Frame P of the body that carries the surface, X_B'P; of the first where there are several.
  [[nodiscard]] virtual Pose pose(const Configuration& q) const = 0;
  /// The same with its derivatives, for kinds of up to three degrees of freedom that move one body.
  [[nodiscard]] virtual RigidMotion motion(const Configuration& q) const = 0;

  // Several bodies carry the surface of a mechanism. The base class has one, with all three of
  // these from motion().

  /// X_B'L of the bodies, as many as asked for.
  virtual void place(const Configuration& q, std::span<Pose> bodies) const;
  [[nodiscard]] virtual BodyTwist twist(const Configuration& q, int body) const;
  /// hessian -= the sum over bodies of g . du/dq for the velocities u by q of the points that g
  /// presses on, beyond what twists alone give.
  virtual void add_motion_curvature(const Configuration& q, std::span<const BodyLoad> loads,
                                    Eigen::Ref<Eigen::MatrixXd> hessian) const;

  [[nodiscard]] virtual int leg_count() const { return 0; }
  /// Fills base joint, knee, platform joint of each leg (3 * leg_count() points), m, in F. A leg
  /// that begins where the one before ends continues it.
  virtual void linkage(const Configuration& q, std::span<Vector3> points_F) const;

  /// Takes up to a second, of a mechanism many; for people, not for loops.
  [[nodiscard]] WorkspaceSummary workspace_summary() const;
  /// Takes up to a second.
  [[nodiscard]] WorkspaceOutline workspace_outline() const;

 protected:
  /// Keeps the settings' axes, mount, home and joint limits.
  explicit Kinematics(const DeviceSettings& settings)
      : axes_(settings.axes),
        X_FB_(settings.X_FB),
        home_(settings.home),
        joint_limits_(settings.joint_limits) {}
  Kinematics(const Kinematics&) = default;
  /// For mounted(): of the class itself.
  [[nodiscard]] virtual std::unique_ptr<Kinematics> copy() const = 0;

  /// Whether q is finite and within the limits of its axes (limits count as inside, to 1e-9).
  [[nodiscard]] bool within_axes(const Configuration& q) const;

  /// Of what tilts and travels; none for others.
  [[nodiscard]] virtual std::optional<PlatformSpace> platform_space() const { return std::nullopt; }
  /// How far each axis goes, of others. Axes that are alike share one entry. The base class has the
  /// limits of the axes.
  [[nodiscard]] virtual std::vector<AxisReach> reaches() const;

  /// The space of these axes, the others at home: where reachable() says so, travel looked for in
  /// [low, high]. Of one that tilts about one axis other directions say nothing: the tilt is taken
  /// about that.
  [[nodiscard]] PlatformSpace space_of(const PlatformAxes& axes, double low, double high,
                                       double max_tilt) const;

 private:
  std::vector<ConfigurationAxis> axes_;
  Pose X_FB_;
  Configuration home_;
  JointLimits joint_limits_;
};

/// q with pitch (axis 0) and roll (axis 1) such that a platform faces along normal_B, at most
/// max_tilt (rad) from level.
[[nodiscard]] Configuration tilted_towards(const Vector3& normal_B, double max_tilt,
                                           const Configuration& q);

}  // namespace softfinger
