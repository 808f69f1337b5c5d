#include "softfinger/device/kinematics.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {

bool Kinematics::within_axes(const Configuration& q) const {
  constexpr double kOnLimit = 1e-9;
  if (q.size() != degrees_of_freedom() || !q.allFinite()) return false;
  for (int k = 0; k < degrees_of_freedom(); ++k) {
    const ConfigurationAxis& axis = axes_[static_cast<std::size_t>(k)];
    if (q[k] < axis.min - kOnLimit || q[k] > axis.max + kOnLimit) return false;
  }
  return true;
}

std::unique_ptr<const Kinematics> Kinematics::mounted(const Pose& X_FB) const {
  std::unique_ptr<Kinematics> other = copy();
  other->X_FB_ = X_FB;
  return other;
}

void Kinematics::clamped_joints(const Configuration& q, JointAngles& joints) const {
  static_cast<void>(inverse_kinematics(q, joints));
  joints = joints.cwiseMax(joint_limits_.min).cwiseMin(joint_limits_.max);
}

bool Kinematics::constraints(const Configuration& /*q*/, Eigen::Ref<Eigen::VectorXd> /*values*/,
                             Eigen::Ref<Eigen::MatrixXd> /*jacobian*/) const {
  return true;
}

void Kinematics::add_constraint_curvature(const Configuration& /*q*/,
                                          const Eigen::Ref<const Eigen::VectorXd>& /*multipliers*/,
                                          Eigen::Ref<Eigen::MatrixXd> /*hessian*/) const {}

std::span<const std::string> Kinematics::constraint_names(int /*k*/) const { return {}; }

Configuration Kinematics::facing(const Vector3& /*normal_F*/, const Configuration& q) const {
  return q;
}

void Kinematics::advance(double distance, Configuration& q) const {
  const int axis = approach_axis();
  if (axis >= 0) q[axis] += distance / axes_[static_cast<std::size_t>(axis)].metric;
}

void Kinematics::place(const Configuration& q, std::span<Pose> bodies) const {
  bodies[0] = pose(q);
}

BodyTwist Kinematics::twist(const Configuration& q, int /*body*/) const {
  const RigidMotion here = motion(q);
  BodyTwist twist(6, here.count);
  for (int k = 0; k < here.count; ++k) {
    const PoseRate& rate = here.rate[static_cast<std::size_t>(k)];
    const Matrix3 spin = rate.rotation * here.X_BP.rotation.transpose();
    twist.col(k) << rate.translation, spin(2, 1), spin(0, 2), spin(1, 0);
  }
  return twist;
}

// A point fixed in B' is at x = R^T r in the body, r from its origin c. With f and K = sum g r^T
// the second derivatives by q_k and q_l are R_kl : K^T R - R_k R^T f . c_l - R_l R^T f . c_k -
// f . c_kl, of which those of twists alone have none.
void Kinematics::add_motion_curvature(const Configuration& q, std::span<const BodyLoad> loads,
                                      Eigen::Ref<Eigen::MatrixXd> hessian) const {
  if (!loads[0].touched) return;
  const RigidMotion here = motion(q);
  if (!here.exact) return;
  const Matrix3& R = here.X_BP.rotation;
  const Vector3& force = loads[0].force;
  const Matrix3 turned = loads[0].force_arm.transpose() * R;
  const auto pushed = [&](const PoseRate& rate) {
    return Vector3(rate.rotation * (R.transpose() * force));
  };
  for (int k = 0; k < here.count; ++k) {
    const PoseRate& by_k = here.rate[static_cast<std::size_t>(k)];
    for (int l = 0; l < here.count; ++l) {
      const PoseRate& by_l = here.rate[static_cast<std::size_t>(l)];
      hessian(k, l) -= pushed(by_k).dot(by_l.translation) + pushed(by_l).dot(by_k.translation);
      if (k >= 2 || l >= 2) continue;
      const PoseRate& bend = here.bend[static_cast<std::size_t>(k + l)];
      hessian(k, l) += bend.rotation.cwiseProduct(turned).sum() - force.dot(bend.translation);
    }
  }
}

void Kinematics::linkage(const Configuration& /*q*/, std::span<Vector3> /*points_F*/) const {}

std::vector<AxisReach> Kinematics::reaches() const {
  std::vector<AxisReach> reaches;
  for (const ConfigurationAxis& axis : axes_) {
    reaches.push_back({axis.name, axis.min, axis.max, axis.unit()});
  }
  return reaches;
}

WorkspaceSummary Kinematics::workspace_summary() const {
  if (const auto space = platform_space()) return summarise_platform_workspace(*space);
  WorkspaceSummary summary;
  summary.reaches = reaches();
  return summary;
}

WorkspaceOutline Kinematics::workspace_outline() const {
  if (const auto space = platform_space()) return outline_platform_workspace(*space);
  WorkspaceOutline outline;
  outline.reaches = reaches();
  return outline;
}

PlatformSpace Kinematics::space_of(const PlatformAxes& axes, double low, double high,
                                   double max_tilt) const {
  return {.axes = axes,
          .reachable =
              [this, axes](double pitch, double roll, double travel) {
                Configuration q = home_;
                if (axes.pitch >= 0 && axes.roll >= 0) {
                  q[axes.pitch] = pitch;
                  q[axes.roll] = roll;
                } else {
                  q[std::max(axes.pitch, axes.roll)] =
                      std::copysign(std::hypot(pitch, roll), pitch);
                }
                q[axes.travel] = travel;
                return reachable(q);
              },
          .low = low,
          .high = high,
          .home_travel = home_[axes.travel],
          .max_tilt = max_tilt};
}

Configuration tilted_towards(const Vector3& normal_B, double max_tilt, const Configuration& q) {
  const double across = std::hypot(normal_B.x(), normal_B.y());
  const double angle = std::min(std::atan2(across, normal_B.z()), max_tilt);
  Configuration turned = q;
  // Straight away from the finger no direction is nearer than another: stay level.
  turned[0] = across > 1e-12 ? angle * normal_B.x() / across : 0.0;
  turned[1] = across > 1e-12 ? -angle * normal_B.y() / across : 0.0;
  return turned;
}

}  // namespace softfinger
