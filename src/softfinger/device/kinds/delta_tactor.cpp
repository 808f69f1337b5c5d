#include "softfinger/device/kinds/delta_tactor.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kLegTolerance = 1e-9;   // rad
constexpr double kForearmMargin = 1e-9;  // m; where a leg is stretched, d(joint)/dq is infinite

}  // namespace

DeltaTactor::DeltaTactor(const DeviceSettings& settings, const DeltaTactorGeometry& geometry)
    : Kinematics(settings), geometry_(geometry) {
  JointAngles joints;
  if (!inverse_kinematics(home(), joints)) return;
  Matrix3 jacobian;
  for (int i = 0; i < 3; ++i) jacobian.row(i) = crank_rate(leg(home(), i), joints[i]);
  home_determinant_ = jacobian.determinant();
}

std::vector<ConfigurationAxis> DeltaTactor::axes_for(const DeltaTactorGeometry& geometry) {
  // As far as stretched legs reach, over the base.
  const double reach = geometry.crank + geometry.forearm;
  const double across = reach + std::abs(geometry.base_radius - geometry.platform_radius);
  return {
      ConfigurationAxis::length("x_mm", -across, across),
      ConfigurationAxis::length("y_mm", -across, across),
      ConfigurationAxis::length("z_mm", -geometry.neutral_height, reach - geometry.neutral_height)};
}

DeltaTactor::Leg DeltaTactor::leg(const Configuration& q, int i) const {
  const double azimuth = 2.0 * std::numbers::pi / 3.0 * i;
  Leg leg;
  leg.outward = {std::cos(azimuth), std::sin(azimuth), 0.0};
  leg.aside = {-std::sin(azimuth), std::cos(azimuth), 0.0};
  const Vector3 tip = q;
  leg.to_platform = {leg.outward.dot(tip) + geometry_.platform_radius - geometry_.base_radius,
                     leg.aside.dot(tip), tip.z() + geometry_.neutral_height};
  return leg;
}

// The forearm's end lies on a ball around the knee: x cos + z sin = (a^2 + |p|^2 - b^2) / (2 a).
bool DeltaTactor::crank_angle(const Vector3& to_platform, double& angle) const {
  const double a = geometry_.crank;
  const double b = geometry_.forearm;
  const double in_plane = std::hypot(to_platform.x(), to_platform.z());
  const double wanted = (a * a + to_platform.squaredNorm() - b * b) / (2.0 * a);
  const double cosine = in_plane > 0.0 ? wanted / in_plane : 2.0;
  angle = std::atan2(to_platform.z(), to_platform.x()) - std::acos(std::clamp(cosine, -1.0, 1.0));
  return std::abs(cosine) < 1.0;
}

// By differentiating |to_platform - knee(angle)|^2 = b^2.
Vector3 DeltaTactor::crank_rate(const Leg& leg, double angle) const {
  const double a = geometry_.crank;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const Vector3 forearm = leg.to_platform - a * Vector3(c, 0.0, s);
  const double across = a * (leg.to_platform.z() * c - leg.to_platform.x() * s);
  return (forearm.x() * leg.outward + forearm.y() * leg.aside + forearm.z() * Vector3::UnitZ()) /
         across;
}

bool DeltaTactor::inverse_kinematics(const Configuration& q, JointAngles& joints) const {
  joints.resize(3);
  for (int i = 0; i < 3; ++i) {
    if (!crank_angle(leg(q, i).to_platform, joints[i])) return false;
  }
  return true;
}

void DeltaTactor::clamped_joints(const Configuration& q, JointAngles& joints) const {
  joints.resize(3);
  for (int i = 0; i < 3; ++i) {
    static_cast<void>(crank_angle(leg(q, i).to_platform, joints[i]));
    joints[i] = std::clamp(joints[i], joint_limits().min[i], joint_limits().max[i]);
  }
}

bool DeltaTactor::forward_kinematics(const JointAngles& joints, Configuration& q) const {
  if (joints.size() != 3 || !joints.allFinite()) return false;
  // Knees moved in by the platform's radius: the tip is one forearm away from each.
  Matrix3 centres;
  for (int i = 0; i < 3; ++i) {
    const double azimuth = 2.0 * std::numbers::pi / 3.0 * i;
    const double out =
        geometry_.base_radius - geometry_.platform_radius + geometry_.crank * std::cos(joints[i]);
    centres.col(i) = Vector3(out * std::cos(azimuth), out * std::sin(azimuth),
                             geometry_.crank * std::sin(joints[i]) - geometry_.neutral_height);
  }
  const Vector3 u = centres.col(1) - centres.col(0);
  const Vector3 v = centres.col(2) - centres.col(0);
  const Vector3 w = u.cross(v);
  const double area2 = w.squaredNorm();
  if (!(area2 > 1e-24)) return false;
  // Centre of the circle through them, and from there along its axis.
  const Vector3 middle =
      centres.col(0) +
      (v.squaredNorm() * w.cross(u) + u.squaredNorm() * v.cross(w)) / (2.0 * area2);
  const double square =
      geometry_.forearm * geometry_.forearm - (middle - centres.col(0)).squaredNorm();
  if (!(square >= 0.0)) return false;
  // The tip may be on either side of the plane of the knees; the workspace says on which.
  const Vector3 up = std::sqrt(square / area2) * (w.z() > 0.0 ? w : Vector3(-w));
  for (const Vector3& off : {up, Vector3(-up)}) {
    q = middle + off;
    JointAngles back;
    if (reachable(q) && inverse_kinematics(q, back) &&
        (back - joints).cwiseAbs().maxCoeff() < 1e-8) {
      return true;
    }
  }
  return false;
}

double DeltaTactor::singularity_ratio(const Configuration& q) const {
  JointAngles joints;
  if (home_determinant_ == 0.0 || !inverse_kinematics(q, joints)) return 0.0;
  Matrix3 jacobian;
  for (int i = 0; i < 3; ++i) jacobian.row(i) = crank_rate(leg(q, i), joints[i]);
  return jacobian.determinant() / home_determinant_;
}

bool DeltaTactor::reachable(const Configuration& q) const {
  JointAngles joints;
  return within_axes(q) && inverse_kinematics(q, joints) &&
         (joints - joint_limits().max).maxCoeff() <= kLegTolerance &&
         (joint_limits().min - joints).maxCoeff() <= kLegTolerance && singularity_ratio(q) > 0.0;
}

bool DeltaTactor::constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                              Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  const double a = geometry_.crank;
  const double b = geometry_.forearm - kForearmMargin;
  for (int i = 0; i < 3; ++i) {
    const Leg here = leg(q, i);
    const Vector3& p = here.to_platform;
    double angle = 0.0;
    if (!crank_angle(p, angle)) return false;
    const Vector3 rate = a * crank_rate(here, angle);
    values[i] = a * (angle - joint_limits().max[i]);
    jacobian.row(i) = rate;
    values[3 + i] = a * (joint_limits().min[i] - angle);
    jacobian.row(3 + i) = -rate;
    // Crank and forearm in one line: (L - a)^2 + y^2 = b^2 with L in the leg's plane.
    const double in_plane = std::hypot(p.x(), p.z());
    const double part = (in_plane - a) / in_plane;
    values[6 + i] = ((in_plane - a) * (in_plane - a) + p.y() * p.y() - b * b) / (2.0 * b);
    jacobian.row(6 + i) =
        (part * p.x() * here.outward + p.y() * here.aside + part * p.z() * Vector3::UnitZ()) / b;
  }
  return true;
}

void DeltaTactor::add_constraint_curvature(const Configuration& q,
                                           const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                           Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const double a = geometry_.crank;
  const double b = geometry_.forearm - kForearmMargin;
  for (int i = 0; i < 3; ++i) {
    const double joint = a * (std::max(0.0, multipliers[i]) - std::max(0.0, multipliers[3 + i]));
    const double reach = std::max(0.0, multipliers[6 + i]) / b;
    if (joint == 0.0 && reach == 0.0) continue;
    const Leg here = leg(q, i);
    const Vector3& p = here.to_platform;
    double angle = 0.0;
    if (!crank_angle(p, angle)) continue;
    Matrix3 axes;  // columns: the leg's axes in B'
    axes << here.outward, here.aside, Vector3::UnitZ();
    Matrix3 bend = Matrix3::Zero();  // in the leg's axes
    // rate = forearm / across; both change with p and with the angle.
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const Vector3 forearm = p - a * Vector3(c, 0.0, s);
    const double across = a * (p.z() * c - p.x() * s);
    const Vector3 rate = forearm / across;
    const Vector3 across_rate = a * Vector3(-s, 0.0, c) - a * (p.z() * s + p.x() * c) * rate;
    const Matrix3 forearm_rate = Matrix3::Identity() - a * Vector3(-s, 0.0, c) * rate.transpose();
    bend += joint / across * (forearm_rate - rate * across_rate.transpose());
    const double in_plane = std::hypot(p.x(), p.z());
    const Vector3 along(p.x() / in_plane, 0.0, p.z() / in_plane);
    Matrix3 curved = Matrix3::Identity();
    curved.diagonal() -= (a / in_plane) * Vector3(1.0, 0.0, 1.0);
    bend += reach * (curved + (a / in_plane) * along * along.transpose());
    hessian += axes * bend * axes.transpose();
  }
}

std::span<const std::string> DeltaTactor::constraint_names(int k) const {
  return {&names_[static_cast<std::size_t>(k % 3)], 1};
}

Pose DeltaTactor::pose(const Configuration& q) const { return {Matrix3::Identity(), Vector3(q)}; }

RigidMotion DeltaTactor::motion(const Configuration& q) const {
  return {
      .X_BP = pose(q),
      .count = 3,
      .rate = {PoseRate{.translation = Vector3::UnitX()}, PoseRate{.translation = Vector3::UnitY()},
               PoseRate{.translation = Vector3::UnitZ()}},
      .exact = true};
}

void DeltaTactor::linkage(const Configuration& q, std::span<Vector3> points_F) const {
  for (int i = 0; i < 3; ++i) {
    const Leg here = leg(q, i);
    double angle = 0.0;
    static_cast<void>(crank_angle(here.to_platform, angle));
    const Vector3 base =
        geometry_.base_radius * here.outward - geometry_.neutral_height * Vector3::UnitZ();
    const Vector3 knee = base + geometry_.crank * (std::cos(angle) * here.outward +
                                                   std::sin(angle) * Vector3::UnitZ());
    const auto at = static_cast<std::size_t>(3 * i);
    points_F[at] = mount() * base;
    points_F[at + 1] = mount() * knee;
    points_F[at + 2] = mount() * Vector3(Vector3(q) + geometry_.platform_radius * here.outward);
  }
}

std::vector<AxisReach> DeltaTactor::reaches() const {
  std::vector<AxisReach> reaches;
  for (int k = 0; k < 3; ++k) {
    const ConfigurationAxis& axis = axes()[static_cast<std::size_t>(k)];
    // Last reachable point from home each way.
    const auto end = [&](double limit) {
      Configuration q = home();
      double inside = home()[k];
      constexpr int kPieces = 4000;
      for (int piece = 1; piece <= kPieces; ++piece) {
        q[k] = home()[k] + (limit - home()[k]) * piece / kPieces;
        if (!reachable(q)) break;
        inside = q[k];
      }
      return inside;
    };
    reaches.push_back({axis.name, end(axis.min), end(axis.max), axis.unit()});
  }
  return reaches;
}

}  // namespace softfinger
