#include "softfinger/device/kinds/cable_platform.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "softfinger/base/units.hpp"
#include "softfinger/device/tilt.hpp"
#include "softfinger/device/workspace.hpp"

namespace softfinger {
namespace {

constexpr double kCableTolerance = 1e-9;  // rad, m and N
constexpr double kLeastLength = 1e-6;     // m

enum CableConstraint { kWoundUp = 0, kLetOut = 3, kSlack = 6, kCableTilt = 9 };

}  // namespace

CablePlatform::CablePlatform(const DeviceSettings& settings, const CablePlatformGeometry& geometry)
    : Kinematics(settings),
      geometry_(geometry),
      neutral_length_(
          std::hypot(geometry.base_radius - geometry.platform_radius, geometry.neutral_height)) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string name = "joint_" + std::to_string(i + 1);
    for (const std::size_t k : {kWoundUp + i, kLetOut + i, kSlack + i}) names_[k] = {name};
  }
  names_[kCableTilt] = {axes()[0].name, axes()[1].name};
}

std::vector<ConfigurationAxis> CablePlatform::axes_for(const CablePlatformGeometry& geometry) {
  const double tilt = geometry.max_tilt;
  return {ConfigurationAxis::angle("pitch_deg", geometry.disk_radius, -tilt, tilt),
          ConfigurationAxis::angle("roll_deg", geometry.disk_radius, -tilt, tilt),
          // From where the spring is slack to where the platform meets the base.
          ConfigurationAxis::length("travel_mm", geometry.neutral_height - geometry.spring_length,
                                    geometry.neutral_height)};
}

std::array<CablePlatform::Cable, 3> CablePlatform::cables(const Configuration& q) const {
  const Tilt tilt(q[0], q[1]);
  const double rp = geometry_.platform_radius;
  std::array<Cable, 3> cables;
  for (int i = 0; i < 3; ++i) {
    const double azimuth = 2.0 * std::numbers::pi / 3.0 * i;
    const double c = std::cos(azimuth);
    const double s = std::sin(azimuth);
    // From the base's point to the platform's, with derivatives by the tilts.
    PlaneFunction x = (-rp * c) * tilt.cosine_pp + (rp * s) * tilt.cosine_pr;
    PlaneFunction y = (rp * c) * tilt.cosine_pr + (-rp * s) * tilt.cosine_rr;
    PlaneFunction z = (-rp * c) * tilt.sine_p + (rp * s) * tilt.sine_r;
    x.v += (rp - geometry_.base_radius) * c;
    y.v += (rp - geometry_.base_radius) * s;
    z.v += q[2] - geometry_.neutral_height;
    const PlaneFunction square = x * x + y * y + z * z;
    Cable& cable = cables[static_cast<std::size_t>(i)];
    cable.length = std::max(std::sqrt(square.v), kLeastLength);
    cable.rate = Vector3(0.5 * square.p, 0.5 * square.r, z.v) / cable.length;
    Matrix3 half;  // second derivatives of half the squared length
    half << 0.5 * square.pp, 0.5 * square.pr, z.p, 0.5 * square.pr, 0.5 * square.rr, z.r, z.p, z.r,
        1.0;
    cable.bend = (half - cable.rate * cable.rate.transpose()) / cable.length;
  }
  return cables;
}

Vector3 CablePlatform::spring_force(const Configuration& q) const {
  const double pressed = geometry_.spring_length - geometry_.neutral_height + q[2];
  return {geometry_.spring_bending * q[0], geometry_.spring_bending * q[1],
          geometry_.spring_stiffness * pressed};
}

bool CablePlatform::tensions(const Configuration& q, Vector3& tension) const {
  const std::array<Cable, 3> here = cables(q);
  Matrix3 rates;
  for (int i = 0; i < 3; ++i) rates.col(i) = here[static_cast<std::size_t>(i)].rate;
  tension = rates.partialPivLu().solve(-spring_force(q));
  return tension.allFinite();
}

bool CablePlatform::inverse_kinematics(const Configuration& q, JointAngles& joints) const {
  joints.resize(3);
  const std::array<Cable, 3> here = cables(q);
  for (int i = 0; i < 3; ++i) {
    joints[i] =
        (neutral_length_ - here[static_cast<std::size_t>(i)].length) / geometry_.winch_radius;
  }
  return true;
}

bool CablePlatform::newton_forward(const JointAngles& joints, Configuration& q) const {
  double left = 1.0;
  for (int iteration = 0; iteration < 40 && left > 1e-14; ++iteration) {
    const std::array<Cable, 3> here = cables(q);
    Matrix3 rates;
    Vector3 lack;
    for (int i = 0; i < 3; ++i) {
      const Cable& cable = here[static_cast<std::size_t>(i)];
      rates.row(i) = cable.rate;
      lack[i] = neutral_length_ - geometry_.winch_radius * joints[i] - cable.length;
    }
    Vector3 step = rates.partialPivLu().solve(lack);
    if (!step.allFinite()) return false;
    left = std::max(
        {std::abs(step[0]), std::abs(step[1]), std::abs(step[2]) / geometry_.neutral_height});
    if (left > 0.3) step *= 0.3 / left;
    q += step;
    if (std::hypot(q[0], q[1]) > 1.5) return false;
  }
  return left < 1e-9;
}

bool CablePlatform::forward_kinematics(const JointAngles& joints, Configuration& q) const {
  if (joints.size() != 3 || !joints.allFinite()) return false;
  q = home();
  if (newton_forward(joints, q) && reachable(q)) return true;
  // In pieces from home's joints, each from the one before.
  JointAngles from;
  static_cast<void>(inverse_kinematics(home(), from));
  constexpr int kPieces = 24;
  q = home();
  for (int piece = 1; piece <= kPieces; ++piece) {
    const JointAngles between = from + (joints - from) * (static_cast<double>(piece) / kPieces);
    if (!newton_forward(between, q)) return false;
  }
  return reachable(q);
}

bool CablePlatform::reachable(const Configuration& q) const {
  if (!within_axes(q) || std::hypot(q[0], q[1]) > geometry_.max_tilt + kCableTolerance)
    return false;
  JointAngles joints;
  Vector3 tension;
  return inverse_kinematics(q, joints) &&
         (joints - joint_limits().max).maxCoeff() <= kCableTolerance &&
         (joint_limits().min - joints).maxCoeff() <= kCableTolerance && tensions(q, tension) &&
         tension.minCoeff() >= geometry_.least_tension - kCableTolerance;
}

bool CablePlatform::constraints(const Configuration& q, Eigen::Ref<Eigen::VectorXd> values,
                                Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  const std::array<Cable, 3> here = cables(q);
  const double winch = geometry_.winch_radius;
  Matrix3 rates;  // dl_i/dq by column
  for (int i = 0; i < 3; ++i) {
    const Cable& cable = here[static_cast<std::size_t>(i)];
    const double wound = neutral_length_ - cable.length;
    values[kWoundUp + i] = wound - winch * joint_limits().max[i];
    jacobian.row(kWoundUp + i) = -cable.rate;
    values[kLetOut + i] = winch * joint_limits().min[i] - wound;
    jacobian.row(kLetOut + i) = cable.rate;
    rates.col(i) = cable.rate;
  }
  // rates t = -dV/dq, so rates dt = -d(dV/dq) - sum t_i d(rate_i).
  const Eigen::PartialPivLU<Matrix3> inverse(rates);
  const Vector3 tension = inverse.solve(-spring_force(q));
  if (!tension.allFinite()) return false;
  Matrix3 change = Matrix3::Zero();
  change.diagonal() << -geometry_.spring_bending, -geometry_.spring_bending,
      -geometry_.spring_stiffness;
  for (int i = 0; i < 3; ++i) change -= tension[i] * here[static_cast<std::size_t>(i)].bend;
  const Matrix3 tension_rate = inverse.solve(change);
  // A third of the spring's stiffness is what one cable feels of it.
  const double softness = 3.0 / geometry_.spring_stiffness;
  for (int i = 0; i < 3; ++i) {
    values[kSlack + i] = softness * (geometry_.least_tension - tension[i]);
    jacobian.row(kSlack + i) = -softness * tension_rate.row(i);
  }
  const double limit = geometry_.max_tilt;
  const double scale = geometry_.disk_radius / limit;
  values[kCableTilt] = 0.5 * scale * (q[0] * q[0] + q[1] * q[1] - limit * limit);
  jacobian.row(kCableTilt) << scale * q[0], scale * q[1], 0.0;
  return true;
}

void CablePlatform::add_constraint_curvature(const Configuration& q,
                                             const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                             Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const std::array<Cable, 3> here = cables(q);
  for (int i = 0; i < 3; ++i) {
    const double let_out =
        std::max(0.0, multipliers[kLetOut + i]) - std::max(0.0, multipliers[kWoundUp + i]);
    hessian += let_out * here[static_cast<std::size_t>(i)].bend;
  }
  const double tilt = std::max(0.0, multipliers[kCableTilt]);
  hessian(0, 0) += tilt * geometry_.disk_radius / geometry_.max_tilt;
  hessian(1, 1) += tilt * geometry_.disk_radius / geometry_.max_tilt;
}

std::span<const std::string> CablePlatform::constraint_names(int k) const {
  return names_[static_cast<std::size_t>(k)];
}

Configuration CablePlatform::facing(const Vector3& normal_F, const Configuration& q) const {
  return tilted_towards(mount().rotation.transpose() * normal_F, geometry_.max_tilt, q);
}

Pose CablePlatform::pose(const Configuration& q) const {
  return {Tilt(q[0], q[1]).rotation(), Vector3(0.0, 0.0, q[2])};
}

RigidMotion CablePlatform::motion(const Configuration& q) const {
  const Tilt tilt(q[0], q[1]);
  return {.X_BP = {tilt.rotation(), Vector3(0.0, 0.0, q[2])},
          .count = 3,
          .rate = {PoseRate{.rotation = tilt.derivative(&PlaneFunction::p)},
                   PoseRate{.rotation = tilt.derivative(&PlaneFunction::r)},
                   PoseRate{.translation = Vector3::UnitZ()}}};
}

void CablePlatform::linkage(const Configuration& q, std::span<Vector3> points_F) const {
  const Pose X_FP = mount() * pose(q);
  for (int i = 0; i < 3; ++i) {
    const double azimuth = 2.0 * std::numbers::pi / 3.0 * i;
    const Vector3 outward(std::cos(azimuth), std::sin(azimuth), 0.0);
    const Vector3 base = mount() * Vector3(geometry_.base_radius * outward +
                                           geometry_.neutral_height * Vector3::UnitZ());
    const Vector3 end = X_FP * Vector3(geometry_.platform_radius * outward);
    const auto at = static_cast<std::size_t>(3 * i);
    points_F[at] = base;
    points_F[at + 1] = 0.5 * (base + end);
    points_F[at + 2] = end;
  }
}

std::optional<PlatformSpace> CablePlatform::platform_space() const {
  return space_of({.pitch = 0, .roll = 1, .travel = 2}, axes()[2].min, axes()[2].max,
                  geometry_.max_tilt);
}

}  // namespace softfinger
