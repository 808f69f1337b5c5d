#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "softfinger/device/disk_surface.hpp"
#include "softfinger/device/kinds/platform_3rrs.hpp"
#include "softfinger/device/kinds/platform_3rrs_legs.hpp"

namespace softfinger {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix63 = Eigen::Matrix<double, 6, 3>;

/// The platform's motion by q: a point fixed in F moves in P with velocity x_P x omega_k - v_k, so
/// a direction n of P sees (n x x_P) . omega_k - n . v_k. Rows 0-2: omega, rows 3-5: v; columns: q.
Matrix63 platform_twist(const Matrix3& rotation, const Tilt& tilt, const PlatformCentre& centre) {
  Matrix63 twist = Matrix63::Zero();
  const auto column = [&](int k, double PlaneFunction::*part) {
    const Matrix3 spin = rotation.transpose() * tilt.derivative(part);
    twist(0, k) = spin(2, 1);
    twist(1, k) = spin(0, 2);
    twist(2, k) = spin(1, 0);
    twist.block<3, 1>(3, k) = rotation.transpose() * Vector3(centre.x.*part, centre.y.*part, 0.0);
  };
  column(0, &PlaneFunction::p);
  column(1, &PlaneFunction::r);
  twist.block<3, 1>(3, 2) = rotation.row(2).transpose();
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

/// Whether the nearest surface of the solid is its flat top, without a square root.
bool sees_top(double radius, double rho2, double z) {
  const double edge = z >= 0.0 ? radius : radius + z * (std::numbers::sqrt2 - 1.0);
  return edge > 0.0 && rho2 <= edge * edge;
}

}  // namespace

ClosestPointResidual Platform3rrs::closest_point_residual(const Configuration& q,
                                                          const Vector3& p_F) const {
  const Tilt tilt(q[0], q[1]);
  const PlatformCentre centre = platform_centre(geometry_, tilt);
  const Pose X_FP = surface_pose(q);
  const Vector3 p_P = X_FP.rotation.transpose() * (p_F - X_FP.translation);
  ClosestPointResidual answer;
  answer.residual = disk_closest_point_residual(geometry_.disk_radius, p_P);
  Matrix3 by_point = Vector3::UnitZ() * Vector3::UnitZ().transpose();
  const double rho = std::hypot(p_P.x(), p_P.y());
  if (rho > geometry_.disk_radius) {
    const Vector3 outward(p_P.x() / rho, p_P.y() / rho, 0.0);
    const Vector3 tangent(-outward.y(), outward.x(), 0.0);
    by_point += outward * outward.transpose() +
                (1.0 - geometry_.disk_radius / rho) * tangent * tangent.transpose();
  }
  const Matrix63 twist = platform_twist(tilt.rotation(), tilt, centre);
  answer.jacobian = by_point * (skew(p_P) * twist.topRows<3>() - twist.bottomRows<3>());
  return answer;
}

SurfaceDistance Platform3rrs::signed_distance(const Configuration& q, const Vector3& p_F) const {
  const Tilt tilt(q[0], q[1]);
  const PlatformCentre centre = platform_centre(geometry_, tilt);
  const Pose X_FP = surface_pose(q);
  const Vector3 p_P = X_FP.rotation.transpose() * (p_F - X_FP.translation);
  const ConeDistance cone = cone_distance(geometry_.disk_radius, p_P);
  const Matrix63 twist = platform_twist(tilt.rotation(), tilt, centre);
  SurfaceDistance answer;
  answer.distance = cone.distance;
  answer.gradient = twist.transpose() * moment_arm(cone.normal, p_P);
  return answer;
}

double Platform3rrs::deviation(const Configuration& q, const SurfaceSamples& samples) const {
  const Pose X_PF = surface_pose(q).inverse();
  const Matrix3& R = X_PF.rotation;
  const Vector3& t = X_PF.translation;
  const double radius = geometry_.disk_radius;
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

double Platform3rrs::deviation_derivatives(const Configuration& q, const SurfaceSamples& samples,
                                           Eigen::Ref<Eigen::VectorXd> gradient,
                                           Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                                           Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const Tilt tilt(q[0], q[1]);
  const PlatformCentre centre = platform_centre(geometry_, tilt);
  const Matrix3 rotation = tilt.rotation();
  const Pose X_PF =
      (settings().X_FB * Pose{rotation, Vector3(centre.x.v, centre.y.v, q[2])}).inverse();
  const Matrix3& R = X_PF.rotation;
  const Vector3& t = X_PF.translation;
  const double radius = geometry_.disk_radius;
  const auto contacts = static_cast<std::size_t>(samples.contact_count);

  DeviationSums sums(platform_twist(rotation, tilt, centre));
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

  gradient = sums.gradient;
  gauss_newton = sums.gauss_newton;
  Matrix3 exact = sums.gauss_newton + sums.curvature;
  const Matrix3& K = sums.force_point;

  // Second derivatives of x_P = M^T (y - c), contracted with f.
  const Matrix3 K_world = rotation * K.transpose();  // sum (y - c) f^T
  const auto second = [&](double PlaneFunction::*part) {
    const double turning = tilt.derivative(part).cwiseProduct(K_world).sum();
    const Vector3 shift(centre.x.*part, centre.y.*part, 0.0);
    return turning - shift.dot(rotation * sums.force);
  };
  const Vector3 pushed_p = tilt.derivative(&PlaneFunction::p) * sums.force;
  const Vector3 pushed_r = tilt.derivative(&PlaneFunction::r) * sums.force;
  const Vector3 shift_p(centre.x.p, centre.y.p, 0.0);
  const Vector3 shift_r(centre.x.r, centre.y.r, 0.0);
  exact(0, 0) += second(&PlaneFunction::pp) - 2.0 * shift_p.dot(pushed_p);
  exact(1, 1) += second(&PlaneFunction::rr) - 2.0 * shift_r.dot(pushed_r);
  const double pr = second(&PlaneFunction::pr) - shift_p.dot(pushed_r) - shift_r.dot(pushed_p);
  exact(0, 1) += pr;
  exact(1, 0) += pr;
  // Travel is z: its product with the tilts comes from the turning alone.
  exact(0, 2) -= pushed_p.z();
  exact(2, 0) -= pushed_p.z();
  exact(1, 2) -= pushed_r.z();
  exact(2, 1) -= pushed_r.z();
  hessian = exact;
  return sums.value;
}

double Platform3rrs::least_distance(const Configuration& q, const SurfaceSamples& samples) const {
  const Pose X_PF = surface_pose(q).inverse();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    const Vector3 p_P = X_PF * Vector3(samples.x[i], samples.y[i], samples.z[i]);
    if (p_P.z() >= least) continue;
    least = std::min(least, cone_distance(geometry_.disk_radius, p_P).distance);
  }
  return least;
}

void Platform3rrs::solid_pieces(const Configuration& q, std::span<SolidPiece> pieces) const {
  pieces[0] = disk_solid(geometry_.disk_radius, geometry_.disk_edge_radius, surface_pose(q));
}

}  // namespace softfinger
