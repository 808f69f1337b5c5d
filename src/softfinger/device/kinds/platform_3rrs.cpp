#include "softfinger/device/kinds/platform_3rrs.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/device/kinds/platform_3rrs_legs.hpp"
#include "softfinger/device/surfaces/exact_disk.hpp"

namespace softfinger {
namespace {

// Constraints keep this far from where a leg is stretched or folded, where d(joint)/dq is infinite.
constexpr double kReachMargin = 1e-9;       // m
constexpr double kLeastDeterminant = 1e-3;  // of home's

enum Constraint {
  kAbove = 0,
  kBelow = 3,
  kTiltLimit = 6,
  kTooLong = 7,
  kTooShort = 10,
  kSingular = 13
};

/// Derivative of crank angle by (pitch, roll, travel).
Vector3 joint_row(const LegPosture& leg, const CrankAngle& crank) {
  return {crank.dx * leg.x.p + crank.dy * leg.y.p, crank.dx * leg.x.r + crank.dy * leg.y.r,
          -crank.dy};
}

}  // namespace

Platform3rrs::Platform3rrs(const DeviceSettings& settings, const Platform3rrsGeometry& geometry)
    : Kinematics(settings), geometry_(geometry) {
  for (std::size_t leg = 0; leg < 3; ++leg) {
    const std::string name = "joint_" + std::to_string(leg + 1);
    for (const std::size_t k : {kAbove + leg, kBelow + leg, kTooLong + leg, kTooShort + leg}) {
      constraint_names_[k] = {name};
    }
  }
  constraint_names_[kTiltLimit] = {"pitch_deg", "roll_deg"};
  constraint_names_[kSingular] = {"pitch_deg", "roll_deg", "travel_mm"};
  Matrix3 jacobian;
  if (joint_jacobian(home(), jacobian)) {
    home_determinant_ = jacobian.determinant() * geometry_.crank;
    explore_workspace();
  }
}

std::vector<ConfigurationAxis> Platform3rrs::axes_for(double disk_radius) {
  return {ConfigurationAxis::angle("pitch_deg", disk_radius),
          ConfigurationAxis::angle("roll_deg", disk_radius),
          ConfigurationAxis::length("travel_mm")};
}

bool Platform3rrs::inverse_kinematics(const Configuration& q, JointAngles& joints) const {
  joints.resize(3);
  const Tilt tilt(q[0], q[1]);
  CrankAngle crank;
  for (int leg = 0; leg < 3; ++leg) {
    const LegPosture posture = leg_posture(geometry_, tilt, q[2], leg);
    if (!crank_angle(geometry_, posture.x.v, posture.y.v, crank)) return false;
    joints[leg] = crank.angle;
  }
  return true;
}

void Platform3rrs::clamped_joints(const Configuration& q, JointAngles& joints) const {
  joints.resize(3);
  const Tilt tilt(q[0], q[1]);
  CrankAngle crank;
  for (int leg = 0; leg < 3; ++leg) {
    const LegPosture posture = leg_posture(geometry_, tilt, q[2], leg);
    // Where the leg does not reach, crank_angle still gives the angle with its argument cut.
    static_cast<void>(crank_angle(geometry_, posture.x.v, posture.y.v, crank));
    joints[leg] = std::clamp(crank.angle, joint_limits().min[leg], joint_limits().max[leg]);
  }
}

bool Platform3rrs::joint_jacobian(const Configuration& q, Matrix3& jacobian) const {
  const Tilt tilt(q[0], q[1]);
  CrankAngle crank;
  for (int leg = 0; leg < 3; ++leg) {
    const LegPosture posture = leg_posture(geometry_, tilt, q[2], leg);
    if (!crank_angle(geometry_, posture.x.v, posture.y.v, crank)) return false;
    jacobian.row(leg) = joint_row(posture, crank);
  }
  return true;
}

double Platform3rrs::singularity_ratio(const Configuration& q) const {
  Matrix3 jacobian;
  if (home_determinant_ == 0.0 || !joint_jacobian(q, jacobian)) return 0.0;
  return jacobian.determinant() * geometry_.crank / home_determinant_;
}

bool Platform3rrs::constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                               Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  const Tilt tilt(q[0], q[1]);
  const double a = geometry_.crank;
  const double longest = a + geometry_.coupler - kReachMargin;
  const double shortest = std::abs(a - geometry_.coupler) + kReachMargin;
  CrankAngle crank;
  Matrix3 joints_by_q;
  for (int leg = 0; leg < 3; ++leg) {
    const LegPosture posture = leg_posture(geometry_, tilt, q[2], leg);
    const double x = posture.x.v;
    const double y = posture.y.v;
    if (!crank_angle(geometry_, x, y, crank)) return false;
    const Vector3 row = joint_row(posture, crank);
    joints_by_q.row(leg) = row;
    values[kAbove + leg] = a * (crank.angle - joint_limits().max[leg]);
    jacobian.row(kAbove + leg) = a * row;
    values[kBelow + leg] = a * (joint_limits().min[leg] - crank.angle);
    jacobian.row(kBelow + leg) = -a * row;
    const Vector3 reach(x * posture.x.p + y * posture.y.p, x * posture.x.r + y * posture.y.r, -y);
    const double square = x * x + y * y;
    values[kTooLong + leg] = (square - longest * longest) / (2.0 * longest);
    jacobian.row(kTooLong + leg) = reach / longest;
    values[kTooShort + leg] = (shortest * shortest - square) / (2.0 * longest);
    jacobian.row(kTooShort + leg) = -reach / longest;
  }
  const double scale = geometry_.disk_radius / geometry_.max_tilt;
  const double limit = geometry_.max_tilt;
  values[kTiltLimit] = 0.5 * scale * (q[0] * q[0] + q[1] * q[1] - limit * limit);
  jacobian.row(kTiltLimit) << scale * q[0], scale * q[1], 0.0;
  values[kSingular] = -geometry_.disk_radius;
  jacobian.row(kSingular).setZero();
  if (may_be_singular_) {
    const double ratio = joints_by_q.determinant() * a / home_determinant_;
    values[kSingular] = geometry_.disk_radius * (kLeastDeterminant - ratio);
    // Needed only near the singularity; differences of the exact Jacobian's determinant there.
    if (ratio < 0.3) {
      for (int k = 0; k < 3; ++k) {
        const double h = 1e-6 / axes()[static_cast<std::size_t>(k)].metric * 1e-2;
        Configuration forward = q;
        Configuration backward = q;
        forward[k] += h;
        backward[k] -= h;
        jacobian(kSingular, k) = -geometry_.disk_radius *
                                 (singularity_ratio(forward) - singularity_ratio(backward)) /
                                 (2.0 * h);
      }
    }
  }
  return true;
}

void Platform3rrs::add_constraint_curvature(const Configuration& q,
                                            const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                            Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const double a = geometry_.crank;
  const double longest = a + geometry_.coupler - kReachMargin;
  const double tilt_multiplier = std::max(0.0, multipliers[kTiltLimit]);
  hessian(0, 0) += tilt_multiplier * geometry_.disk_radius / geometry_.max_tilt;
  hessian(1, 1) += tilt_multiplier * geometry_.disk_radius / geometry_.max_tilt;
  const Tilt tilt(q[0], q[1]);
  for (int leg = 0; leg < 3; ++leg) {
    const double joint =
        a * (std::max(0.0, multipliers[kAbove + leg]) - std::max(0.0, multipliers[kBelow + leg]));
    const double reach =
        (std::max(0.0, multipliers[kTooLong + leg]) - std::max(0.0, multipliers[kTooShort + leg])) /
        longest;
    if (joint == 0.0 && reach == 0.0) continue;
    const LegPosture posture = leg_posture(geometry_, tilt, q[2], leg);
    const PlaneFunction& x = posture.x;
    const PlaneFunction& y = posture.y;
    CrankAngle crank;
    if (!crank_angle(geometry_, x.v, y.v, crank)) continue;
    // Second derivatives of f(x, y) with x, y functions of q: chain rule.
    const double fx = joint * crank.dx + reach * x.v;
    const double fy = joint * crank.dy + reach * y.v;
    const double fxx = joint * crank.dxx + reach;
    const double fxy = joint * crank.dxy;
    const double fyy = joint * crank.dyy + reach;
    const Vector3 gx(x.p, x.r, 0.0);
    const Vector3 gy(y.p, y.r, -1.0);
    hessian += fxx * gx * gx.transpose() + fxy * (gx * gy.transpose() + gy * gx.transpose()) +
               fyy * gy * gy.transpose();
    hessian(0, 0) += fx * x.pp + fy * y.pp;
    hessian(0, 1) += fx * x.pr + fy * y.pr;
    hessian(1, 0) += fx * x.pr + fy * y.pr;
    hessian(1, 1) += fx * x.rr + fy * y.rr;
  }
}

std::span<const std::string> Platform3rrs::constraint_names(int k) const {
  return constraint_names_[static_cast<std::size_t>(k)];
}

Pose Platform3rrs::pose(const Configuration& q) const {
  const Tilt tilt(q[0], q[1]);
  const PlatformCentre centre = platform_centre(geometry_, tilt);
  return {tilt.rotation(), Vector3(centre.x.v, centre.y.v, q[2])};
}

RigidMotion Platform3rrs::motion(const Configuration& q) const {
  const Tilt tilt(q[0], q[1]);
  const PlatformCentre centre = platform_centre(geometry_, tilt);
  const auto part = [&](double PlaneFunction::*which) {
    return PoseRate{tilt.derivative(which), Vector3(centre.x.*which, centre.y.*which, 0.0)};
  };
  return {.X_BP = {tilt.rotation(), Vector3(centre.x.v, centre.y.v, q[2])},
          .count = 3,
          .rate = {part(&PlaneFunction::p), part(&PlaneFunction::r),
                   PoseRate{.translation = Vector3::UnitZ()}},
          .exact = true,
          .bend = {part(&PlaneFunction::pp), part(&PlaneFunction::pr), part(&PlaneFunction::rr)}};
}

void Platform3rrs::linkage(const Configuration& q, std::span<Vector3> points_F) const {
  const Pose X_FP = mount() * pose(q);
  const Tilt tilt(q[0], q[1]);
  for (int leg = 0; leg < 3; ++leg) {
    const auto i = static_cast<std::size_t>(leg);
    const LegPosture posture = leg_posture(geometry_, tilt, q[2], leg);
    CrankAngle crank;
    static_cast<void>(crank_angle(geometry_, posture.x.v, posture.y.v, crank));
    const Vector3 u(kLegCosine[i], kLegSine[i], 0.0);
    const Vector3 base = geometry_.base_radius * u + geometry_.neutral_height * Vector3::UnitZ();
    const Vector3 knee = base + geometry_.crank * (std::cos(crank.angle) * u -
                                                   std::sin(crank.angle) * Vector3::UnitZ());
    points_F[3 * i] = mount() * base;
    points_F[3 * i + 1] = mount() * knee;
    points_F[3 * i + 2] = X_FP * Vector3(geometry_.platform_radius * u);
  }
}

Configuration Platform3rrs::facing(const Vector3& normal_F, const Configuration& q) const {
  return tilted_towards(mount().rotation.transpose() * normal_F, geometry_.max_tilt, q);
}

std::shared_ptr<const Device> make_platform_3rrs(DeviceSettings settings,
                                                 const Platform3rrsGeometry& geometry) {
  auto kinematics = std::make_unique<const Platform3rrs>(settings, geometry);
  return std::make_shared<const Device>(
      std::move(settings), std::move(kinematics),
      std::make_unique<const ExactDisk>(geometry.disk_radius, geometry.disk_edge_radius));
}

}  // namespace softfinger
