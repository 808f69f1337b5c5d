#include "softfinger/device/surfaces/exact_disk.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "softfinger/device/surfaces/disk_geometry.hpp"

namespace softfinger {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix63 = Eigen::Matrix<double, 6, 3>;

/// The disk's motion by q: a point fixed in F moves in P with velocity x_P x omega_k - v_k, so a
/// direction n of P sees (n x x_P) . omega_k - n . v_k. Rows 0-2: omega, rows 3-5: v; columns: q.
Matrix63 disk_twist(const RigidMotion& motion) {
  const Matrix3& rotation = motion.X_BP.rotation;
  Matrix63 twist = Matrix63::Zero();
  for (int k = 0; k < motion.count; ++k) {
    const PoseRate& rate = motion.rate[static_cast<std::size_t>(k)];
    const Matrix3 spin = rotation.transpose() * rate.rotation;
    twist(0, k) = spin(2, 1);
    twist(1, k) = spin(0, 2);
    twist(2, k) = spin(1, 0);
    twist.block<3, 1>(3, k) = rotation.transpose() * rate.translation;
  }
  return twist;
}

Vector6 moment_arm(const Vector3& n, const Vector3& p_P) {
  Vector6 arm;
  arm << n.cross(p_P), -n;
  return arm;
}

/// What E's derivatives need, summed over samples; positions in P.
class DeviationSums {
 public:
  explicit DeviationSums(const Matrix63& twist)
      : omega_(twist.topRows<3>()), v_(twist.bottomRows<3>()) {}

  double value = 0.0;
  Matrix3 force_point = Matrix3::Zero();  ///< sum f x^T, f the derivative of E by x
  Vector3 force = Vector3::Zero();        ///< sum f
  Vector3 gradient = Vector3::Zero();
  Matrix3 gauss_newton = Matrix3::Zero();
  Matrix3 curvature =
      Matrix3::Zero();  ///< what bending of the distance adds to the Gauss-Newton part

  /// A sample that sees the flat top only: n = z.
  void add_top(double weight, double lack, double x, double y, double z) {
    const double w2 = 2.0 * weight;
    const double f = w2 * lack;
    const double wx = w2 * x;
    const double wy = w2 * y;
    top_value_ += f * lack;
    w_ += w2;
    wx_ += wx;
    wy_ += wy;
    wxx_ += wx * x;
    wxy_ += wx * y;
    wyy_ += wy * y;
    f_ += f;
    fx_ += f * x;
    fy_ += f * y;
    fz_ += f * z;
  }
  /// A residual along n.
  void add(double weight, double lack, const Vector3& n, const Vector3& p_P) {
    const Vector3 f = (2.0 * weight * lack) * n;
    value += weight * lack * lack;
    force += f;
    force_point += f * p_P.transpose();
    const Vector3 row = by_q(n, p_P);
    gradient += (2.0 * weight * lack) * row;
    add_square(2.0 * weight, row, gauss_newton);
  }
  void add_curvature(double factor, const Vector3& n, const Vector3& p_P) {
    add_square(factor, by_q(n, p_P), curvature);
  }
  void add_gauss_newton(double factor, const Vector3& n, const Vector3& p_P) {
    add_square(factor, by_q(n, p_P), gauss_newton);
  }
  /// Works in the sums of the flat top: each sample's row is -y omega_0 + x omega_1 - v_2.
  void finish() {
    value += 0.5 * top_value_;
    force.z() += f_;
    force_point.row(2) += Eigen::RowVector3d(fx_, fy_, fz_);
    const Vector3 a = omega_.row(0);
    const Vector3 b = omega_.row(1);
    const Vector3 c = v_.row(2);
    gradient += fx_ * b - fy_ * a - f_ * c;
    gauss_newton += wyy_ * a * a.transpose() + wxx_ * b * b.transpose() + w_ * c * c.transpose() -
                    wxy_ * (a * b.transpose() + b * a.transpose()) +
                    wy_ * (a * c.transpose() + c * a.transpose()) -
                    wx_ * (b * c.transpose() + c * b.transpose());
  }

 private:
  [[nodiscard]] Vector3 by_q(const Vector3& n, const Vector3& p_P) const {
    return omega_.transpose() * n.cross(p_P) - v_.transpose() * n;
  }
  static void add_square(double factor, const Vector3& row, Matrix3& sum) {
    sum += (factor * row) * row.transpose();
  }

  Matrix3 omega_, v_;
  double top_value_ = 0.0;
  double w_ = 0.0, wx_ = 0.0, wy_ = 0.0, wxx_ = 0.0, wxy_ = 0.0, wyy_ = 0.0;
  double f_ = 0.0, fx_ = 0.0, fy_ = 0.0, fz_ = 0.0;
};

/// Second derivatives of x_P = M^T (y - c) by q, contracted with the forces f on the points:
/// `force` is sum f, `force_point` sum f x^T.
void add_bending(const RigidMotion& motion, const Vector3& force, const Matrix3& force_point,
                 Matrix3& exact) {
  const Matrix3& rotation = motion.X_BP.rotation;
  const Matrix3 K_world = rotation * force_point.transpose();  // sum (y - c) f^T
  const Vector3 force_B = rotation * force;
  std::array<Vector3, RigidMotion::kMostAxes> pushed;
  for (int k = 0; k < motion.count; ++k) {
    pushed[static_cast<std::size_t>(k)] = motion.rate[static_cast<std::size_t>(k)].rotation * force;
  }
  for (int k = 0; k < motion.count; ++k) {
    for (int l = k; l < motion.count; ++l) {
      const auto a = static_cast<std::size_t>(k);
      const auto b = static_cast<std::size_t>(l);
      double second = 0.0;
      if (l < 2) {
        const PoseRate& bend = motion.bend[a + b];
        second = bend.rotation.cwiseProduct(K_world).sum() - bend.translation.dot(force_B);
      }
      if (k == l) {
        exact(k, k) += second - 2.0 * motion.rate[a].translation.dot(pushed[a]);
      } else {
        second -= motion.rate[a].translation.dot(pushed[b]);
        second -= motion.rate[b].translation.dot(pushed[a]);
        exact(k, l) += second;
        exact(l, k) += second;
      }
    }
  }
}

/// Whether the nearest surface of the solid is its flat top, without a square root.
bool sees_top(double radius, double rho2, double z) {
  const double edge = z >= 0.0 ? radius : radius + z * (std::numbers::sqrt2 - 1.0);
  return edge > 0.0 && rho2 <= edge * edge;
}

}  // namespace

ClosestPointResidual ExactDisk::closest_point_residual(const Kinematics& by, const Configuration& q,
                                                       const Vector3& p_F) const {
  const RigidMotion motion = by.motion(q);
  const Pose X_FP = by.mount() * motion.X_BP;
  const Vector3 p_P = X_FP.rotation.transpose() * (p_F - X_FP.translation);
  ClosestPointResidual answer;
  answer.residual = disk_closest_point_residual(disk_radius(), p_P);
  Matrix3 by_point = Vector3::UnitZ() * Vector3::UnitZ().transpose();
  const double rho = std::hypot(p_P.x(), p_P.y());
  if (rho > disk_radius()) {
    const Vector3 outward(p_P.x() / rho, p_P.y() / rho, 0.0);
    const Vector3 tangent(-outward.y(), outward.x(), 0.0);
    by_point +=
        outward * outward.transpose() + (1.0 - disk_radius() / rho) * tangent * tangent.transpose();
  }
  const Matrix63 twist = disk_twist(motion);
  const Matrix3 jacobian = by_point * (skew(p_P) * twist.topRows<3>() - twist.bottomRows<3>());
  answer.jacobian = jacobian.leftCols(motion.count);
  return answer;
}

SurfaceDistance ExactDisk::signed_distance(const Kinematics& by, const Configuration& q,
                                           const Vector3& p_F) const {
  const RigidMotion motion = by.motion(q);
  const Pose X_FP = by.mount() * motion.X_BP;
  const Vector3 p_P = X_FP.rotation.transpose() * (p_F - X_FP.translation);
  const ConeDistance cone = cone_distance(disk_radius(), p_P);
  const Matrix63 twist = disk_twist(motion);
  SurfaceDistance answer;
  answer.distance = cone.distance;
  const Vector3 gradient = twist.transpose() * moment_arm(cone.normal, p_P);
  answer.gradient = gradient.head(motion.count);
  return answer;
}

double ExactDisk::deviation(const Kinematics& by, const Configuration& q,
                            const SurfaceSamples& samples) const {
  const Pose X_PF = pose(by, q).inverse();
  const Matrix3& R = X_PF.rotation;
  const Vector3& t = X_PF.translation;
  const double radius = disk_radius();
  const auto contacts = static_cast<std::size_t>(samples.contact_count);
  double sum = 0.0;
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    const double px = samples.x[i];
    const double py = samples.y[i];
    const double pz = samples.z[i];
    const double z = R(2, 0) * px + R(2, 1) * py + R(2, 2) * pz + t.z();
    if (i >= contacts && z >= samples.margin[i]) continue;
    const double x = R(0, 0) * px + R(0, 1) * py + R(0, 2) * pz + t.x();
    const double y = R(1, 0) * px + R(1, 1) * py + R(1, 2) * pz + t.y();
    const double rho2 = x * x + y * y;
    if (i < contacts) {
      const double beyond = rho2 > radius * radius ? std::sqrt(rho2) - radius : 0.0;
      sum += samples.weight[i] * (z * z + beyond * beyond);
    } else {
      const double distance =
          sees_top(radius, rho2, z) ? z : cone_distance(radius, {x, y, z}).distance;
      const double lack = distance - samples.margin[i];
      if (lack < 0.0) sum += samples.weight[i] * lack * lack;
    }
  }
  return sum;
}

double ExactDisk::deviation_derivatives(const Kinematics& by, const Configuration& q,
                                        const SurfaceSamples& samples,
                                        Eigen::Ref<Eigen::VectorXd> gradient,
                                        Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                                        Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const RigidMotion motion = by.motion(q);
  const Pose X_PF = (by.mount() * motion.X_BP).inverse();
  const Matrix3& R = X_PF.rotation;
  const Vector3& t = X_PF.translation;
  const double radius = disk_radius();
  const auto contacts = static_cast<std::size_t>(samples.contact_count);

  DeviationSums sums(disk_twist(motion));
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    const double px = samples.x[i];
    const double py = samples.y[i];
    const double pz = samples.z[i];
    const double z = R(2, 0) * px + R(2, 1) * py + R(2, 2) * pz + t.z();
    // The solid's distance is never less than the height over its top.
    if (i >= contacts && z >= samples.margin[i]) continue;
    const double x = R(0, 0) * px + R(0, 1) * py + R(0, 2) * pz + t.x();
    const double y = R(1, 0) * px + R(1, 1) * py + R(1, 2) * pz + t.y();
    const double w = samples.weight[i];
    const double rho2 = x * x + y * y;
    if (i < contacts) {
      sums.add_top(w, z, x, y, z);
      if (rho2 > radius * radius) {
        const double rho = std::sqrt(rho2);
        const Vector3 p_P(x, y, z);
        const Vector3 outward(x / rho, y / rho, 0.0);
        const Vector3 tangent(-outward.y(), outward.x(), 0.0);
        sums.add(w, rho - radius, outward, p_P);
        const double part = 1.0 - radius / rho;
        sums.add_gauss_newton(2.0 * w * part * part, tangent, p_P);
        sums.add_curvature(2.0 * w * (part - part * part), tangent, p_P);
      }
    } else if (sees_top(radius, rho2, z)) {
      sums.add_top(w, z - samples.margin[i], x, y, z);
    } else {
      const Vector3 p_P(x, y, z);
      const ConeDistance cone = cone_distance(radius, p_P);
      const double lack = cone.distance - samples.margin[i];
      if (lack >= 0.0) continue;
      sums.add(w, lack, cone.normal, p_P);
      sums.add_curvature(2.0 * w * lack * cone.tangent_curvature, cone.tangent, p_P);
      if (cone.meridian_curvature > 0.0) {
        sums.add_curvature(2.0 * w * lack * cone.meridian_curvature,
                           cone.tangent.cross(cone.normal), p_P);
      }
    }
  }
  sums.finish();

  Matrix3 exact = sums.gauss_newton + sums.curvature;
  add_bending(motion, sums.force, sums.force_point, exact);
  const int n = motion.count;
  gradient = sums.gradient.head(n);
  gauss_newton = sums.gauss_newton.topLeftCorner(n, n);
  hessian = exact.topLeftCorner(n, n);
  return sums.value;
}

}  // namespace softfinger
