#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "softfinger/device/configuration.hpp"
#include "softfinger/device/device_objectives.hpp"
#include "softfinger/device/surface_samples.hpp"
#include "softfinger/geometry/pose.hpp"
#include "softfinger/geometry/signed_distance.hpp"
#include "softfinger/motors/joint_limits.hpp"
#include "softfinger/motors/transport_settings.hpp"

namespace softfinger {

/// One component of a configuration q.
struct ConfigurationAxis {
  std::string name;     ///< with the unit people read: "pitch_deg", "travel_mm"
  double unit = 1.0;    ///< SI per that unit: pi/180, 1e-3
  double metric = 1.0;  ///< m per SI unit: how far the surface moves; the disk's radius for angles
  /// Limits of its own; SI. Infinite where only joints or other axes limit it.
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// `[matching]` of a device file.
struct MatchingSettings {
  double separation_tolerance = 2e-4;  ///< eps, m
  double approach = 3e-3;              ///< least gap below which the device follows the skin, m
  std::string objective{kDeviceObjectives.front()};
};

/// `[force_sensor]` of a device file: what tells the force on the wearer's finger.
struct ForceSensorSettings {
  std::string kind;    ///< "emulator"
  double noise = 0.0;  ///< of the emulated sensor, standard deviation, N
};

/// What every kind of device has beside its geometry.
struct DeviceSettings {
  std::string kind;
  std::vector<ConfigurationAxis> axes;
  Pose X_FB;  ///< mount: neutral frame B' in F
  /// How far X_FB stands further out, against its z, than the file says, to fit a finger; m.
  double mount_shift = 0.0;
  /// Least gap to the resting skin of whoever wears it that the mount is shifted to, where the
  /// configuration is zero (at home where that is out of reach), m.
  std::optional<double> clearance;
  Configuration home;       ///< where the device rests when nothing is near
  Configuration retracted;  ///< where it goes when a run stops or stalls
  JointLimits joint_limits;
  double max_force = 0.0;  ///< normal force on the finger that is never exceeded, N; 0: not given
  MatchingSettings matching;
  std::optional<TransportSettings> transport;
  std::optional<ForceSensorSettings> force_sensor;
  std::string as_read;  ///< the device file as JSON, defaults filled in
};

using SurfaceJacobian =
    Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxDegreesOfFreedom>;

/// From the nearest point of the contacting surface to a point: its squared norm is dist^2.
struct ClosestPointResidual {
  Vector3 residual;          ///< m, in a frame that moves with the surface
  SurfaceJacobian jacobian;  ///< by q, 3 x dof
};

/// Signed distance of a point to the device's solid, positive outside.
struct SurfaceDistance {
  double distance;         ///< m
  Configuration gradient;  ///< by q, dof
};

/// A rigid part of the solid that presses the wearer's finger.
struct SolidPiece {
  Shape shape;
  Pose X_FS;  ///< its frame in F
};

/// How far an axis goes with the others at home.
struct AxisReach {
  std::string name;
  double min = 0.0, max = 0.0;  ///< SI
  double unit = 1.0;            ///< SI per unit of the name
};

/// Answer of `device workspace`.
struct WorkspaceSummary {
  /// Where there is no travel and tilt to tell of. Axes that are alike share one entry.
  std::vector<AxisReach> reaches;
  double min_travel = 0.0, max_travel = 0.0;  ///< at zero tilt, m
  double mid_travel = 0.0;                    ///< m
  double min_tilt_at_mid_travel = 0.0;        ///< least over directions, rad
  double max_tilt = 0.0;                      ///< largest anywhere in the workspace, rad
};

/// A workspace as it is drawn: layers of tilt where it tilts and travels, else reaches.
struct WorkspaceOutline {
  std::vector<AxisReach> reaches;
  /// Tilts reached from zero at one travel.
  struct TiltLayer {
    double travel = 0.0;        ///< m
    std::vector<double> tilts;  ///< rad; entry k of n in direction (pitch, roll) = 2 pi k / n
  };
  std::vector<TiltLayer> tilt_layers;  ///< from the least travel to the greatest
  /// Which axes pitch, roll and travel are; -1 where there is none.
  int pitch_axis = -1, roll_axis = -1, travel_axis = -1;
};

class PinField;

/// A device that touches the wearer's finger, as matching, actuation and the twin know it.
/// Immutable and shared by threads. Nothing but the constructors allocates or throws.
class Device {
 public:
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  [[nodiscard]] const DeviceSettings& settings() const { return settings_; }
  [[nodiscard]] const std::string& kind() const { return settings_.kind; }
  [[nodiscard]] int degrees_of_freedom() const { return static_cast<int>(settings_.axes.size()); }
  [[nodiscard]] int joint_count() const {
    return static_cast<int>(settings_.joint_limits.min.size());
  }
  [[nodiscard]] std::span<const ConfigurationAxis> axes() const { return settings_.axes; }
  [[nodiscard]] const Configuration& home() const { return settings_.home; }
  [[nodiscard]] const Configuration& retracted() const { return settings_.retracted; }
  [[nodiscard]] const JointLimits& joint_limits() const { return settings_.joint_limits; }
  /// Squared distance of two configurations in the metric of the axes, m^2.
  [[nodiscard]] double squared_distance(const Configuration& a, const Configuration& b) const;

  /// Joint angles of q; false where the linkage does not close (joints are then unspecified).
  /// Joint limits are not looked at.
  [[nodiscard]] virtual bool inverse_kinematics(const Configuration& q,
                                                JointAngles& joints) const = 0;
  /// Joint angles for any q: the nearest that exist, cut to the joint limits.
  virtual void clamped_joints(const Configuration& q, JointAngles& joints) const = 0;
  /// The configuration inside the workspace that has these joint angles; false if there is none.
  [[nodiscard]] virtual bool forward_kinematics(const JointAngles& joints,
                                                Configuration& q) const = 0;
  /// Whether q lies in the workspace (limits count as inside, to 1e-9).
  [[nodiscard]] virtual bool reachable(const Configuration& q) const = 0;

  /// The workspace as inequalities c_k(q) <= 0, scaled to be comparable with metres of surface
  /// motion: joint limits, linkage reach, tilt, distance to singularity.
  [[nodiscard]] virtual int constraint_count() const = 0;
  /// values: constraint_count; jacobian: constraint_count x dof. False where they are undefined
  /// (q is then far outside).
  [[nodiscard]] virtual bool constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                                         Eigen::Ref<Eigen::MatrixXd> jacobian) const = 0;
  /// hessian += sum of multiplier_k d2c_k/dq2, for the k with a multiplier above zero.
  virtual void add_constraint_curvature(const Configuration& q,
                                        const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                        Eigen::Ref<Eigen::MatrixXd> hessian) const = 0;
  /// Names of what is at its limit where constraint k is active: "joint_1" or axis names.
  [[nodiscard]] virtual std::span<const std::string> constraint_names(int k) const = 0;

  [[nodiscard]] virtual ClosestPointResidual closest_point_residual(const Configuration& q,
                                                                    const Vector3& p_F) const = 0;
  [[nodiscard]] virtual SurfaceDistance signed_distance(const Configuration& q,
                                                        const Vector3& p_F) const = 0;
  /// Contact surface deviation E(q) = sum over C of w dist^2 + sum over N of w min(0, sdist -
  /// eps)^2, m^2.
  [[nodiscard]] virtual double deviation(const Configuration& q,
                                         const SurfaceSamples& samples) const;
  /// The same with dE/dq (dof), the Gauss-Newton matrix 2 J^T J and the exact second derivative
  /// d2E/dq2 (both dof x dof), all overwritten. The base class has no second derivative of the
  /// surface and gives the Gauss-Newton matrix for both.
  virtual double deviation_derivatives(const Configuration& q, const SurfaceSamples& samples,
                                       Eigen::Ref<Eigen::VectorXd> gradient,
                                       Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                                       Eigen::Ref<Eigen::MatrixXd> hessian) const;
  /// Least signed distance over points, m; infinity if there are none.
  [[nodiscard]] virtual double least_distance(const Configuration& q,
                                              const SurfaceSamples& samples) const;

  /// q turned so that the surface faces along normal_F (unit, towards the finger) as far as its
  /// limits allow, other axes as they are. Kinds that cannot turn return q.
  [[nodiscard]] virtual Configuration facing(const Vector3& normal_F,
                                             const Configuration& q) const = 0;
  /// Axis that moves the surface towards the finger; -1 where there is no single one.
  [[nodiscard]] virtual int approach_axis() const = 0;
  /// Whether advance() moves the surface.
  [[nodiscard]] virtual bool advances() const { return approach_axis() >= 0; }
  /// Moves the whole surface towards the finger by `distance` (m); limits are not looked at.
  virtual void advance(double distance, Configuration& q) const;

  /// Pose of the contacting surface's frame P in F; z towards the finger.
  [[nodiscard]] virtual Pose surface_pose(const Configuration& q) const = 0;
  /// The solid that presses a finger at q, as solid_piece_count() parts. It is what the surface
  /// above is an ideal of: with the thickness and rounded rims of the thing itself.
  [[nodiscard]] virtual int solid_piece_count() const { return 1; }
  virtual void solid_pieces(const Configuration& q, std::span<SolidPiece> pieces) const = 0;

  /// The pins of a surface made of pins that move one by one, component k of q the height of pin k;
  /// null for other surfaces.
  [[nodiscard]] virtual const PinField* pin_field() const { return nullptr; }
  /// Radius of a disk surface, m; 0 for other surfaces.
  [[nodiscard]] virtual double disk_radius() const { return 0.0; }
  /// Rounding of the disk's rim, for the solid that presses a finger, m.
  [[nodiscard]] virtual double disk_edge_radius() const { return 0.0; }
  /// Radius of the ring that a cap bulges from, m: of the ball that is its first solid piece only
  /// what is above the ring is the cap. 0 for other surfaces.
  [[nodiscard]] virtual double cap_radius() const { return 0.0; }
  [[nodiscard]] virtual int leg_count() const { return 0; }
  /// Fills base joint, knee, platform joint of each leg (3 * leg_count() points), m, in F. A leg
  /// that begins where the one before ends continues it.
  virtual void linkage(const Configuration& q, std::span<Vector3> points_F) const;

  /// Takes up to a second, of a mechanism many; for people, not for loops.
  [[nodiscard]] virtual WorkspaceSummary workspace_summary() const = 0;
  /// Takes up to a second. The base class has the reaches of the summary.
  [[nodiscard]] virtual WorkspaceOutline workspace_outline() const;

 protected:
  explicit Device(DeviceSettings settings) : settings_(std::move(settings)) {}

  /// Whether q is finite and within the limits of its axes (limits count as inside, to 1e-9).
  [[nodiscard]] bool within_axes(const Configuration& q) const;

 private:
  DeviceSettings settings_;
};

}  // namespace softfinger
