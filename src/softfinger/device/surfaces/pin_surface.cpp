#include "softfinger/device/surfaces/pin_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softfinger {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

PinSurface::PinSurface(const PinArrayGeometry& geometry, const Pose& X_FB)
    : geometry_(geometry),
      field_(geometry.rows, geometry.columns, geometry.pitch, geometry.pin_radius, X_FB) {}

PinSurface::Nearest PinSurface::nearest_end(const Configuration& q, const Vector3& p_B) const {
  Nearest nearest{0, kInfinity};
  field_.around(
      p_B.x(), p_B.y(), [&] { return nearest.distance; },
      [&](int pin, double beyond) {
        const double distance = std::hypot(std::max(0.0, beyond), p_B.z() - q[pin]);
        if (distance < nearest.distance) nearest = {pin, distance};
      });
  return nearest;
}

PinSurface::Nearest PinSurface::nearest_pin(const Configuration& q, const Vector3& p_B,
                                            double within) const {
  Nearest nearest{-1, within};
  field_.around(
      p_B.x(), p_B.y(), [&] { return nearest.distance; },
      [&](int pin, double beyond) {
        const double distance = pin_distance(beyond, p_B.z() - q[pin]).distance;
        if (distance < nearest.distance) nearest = {pin, distance};
      });
  return nearest;
}

ClosestPointResidual PinSurface::closest_point_residual(const Kinematics& /*by*/,
                                                        const Configuration& q,
                                                        const Vector3& p_F) const {
  const Vector3 p_B = field_.in_mount(p_F);
  const int pin = nearest_end(q, p_B).pin;
  const double dx = p_B.x() - field_.x(pin);
  const double dy = p_B.y() - field_.y(pin);
  const double rho = std::hypot(dx, dy);
  const double part = rho > field_.radius() ? 1.0 - field_.radius() / rho : 0.0;
  ClosestPointResidual answer;
  answer.residual = {part * dx, part * dy, p_B.z() - q[pin]};
  answer.jacobian.setZero(3, field_.count());
  answer.jacobian(2, pin) = -1.0;
  return answer;
}

SurfaceDistance PinSurface::signed_distance(const Kinematics& /*by*/, const Configuration& q,
                                            const Vector3& p_F) const {
  const Vector3 p_B = field_.in_mount(p_F);
  const int pin = nearest_pin(q, p_B, kInfinity).pin;
  const PinDistance distance = pin_distance(field_.beyond(pin, p_B.x(), p_B.y()), p_B.z() - q[pin]);
  SurfaceDistance answer{distance.distance, {}};
  answer.gradient.setZero(field_.count());
  answer.gradient[pin] = distance.by_height;
  return answer;
}

// A sample that must keep clear lacks nothing where it is higher over all pins than its margin, and
// no pin further aside than that makes it lack anything.
double PinSurface::deviation(const Kinematics& /*by*/, const Configuration& q,
                             const SurfaceSamples& samples) const {
  const double highest = q.maxCoeff();
  double sum = 0.0;
  for (int i = 0; i < samples.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    const Vector3 p_B = field_.in_mount({samples.x[s], samples.y[s], samples.z[s]});
    const double margin = samples.margin[s];
    double lack = 0.0;
    if (i < samples.contact_count) {
      lack = nearest_end(q, p_B).distance;
    } else if (p_B.z() - highest < margin) {
      lack = nearest_pin(q, p_B, margin).distance - margin;
    }
    sum += samples.weight[s] * lack * lack;
  }
  return sum;
}

double PinSurface::deviation_derivatives(const Kinematics& /*by*/, const Configuration& q,
                                         const SurfaceSamples& samples,
                                         Eigen::Ref<Eigen::VectorXd> gradient,
                                         Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                                         Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const double highest = q.maxCoeff();
  gradient.setZero();
  gauss_newton.setZero();
  double sum = 0.0;
  const auto add = [&](double weight, double square, int pin, double lack, double by_height) {
    sum += weight * square;
    gradient[pin] += 2.0 * weight * lack * by_height;
    gauss_newton(pin, pin) += 2.0 * weight * by_height * by_height;
  };
  for (int i = 0; i < samples.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    const Vector3 p_B = field_.in_mount({samples.x[s], samples.y[s], samples.z[s]});
    const double weight = samples.weight[s];
    const double margin = samples.margin[s];
    if (i < samples.contact_count) {
      const Nearest nearest = nearest_end(q, p_B);
      add(weight, nearest.distance * nearest.distance, nearest.pin, p_B.z() - q[nearest.pin], -1.0);
    } else if (p_B.z() - highest < margin) {
      const int pin = nearest_pin(q, p_B, margin).pin;
      if (pin < 0) continue;
      const PinDistance to_pin =
          pin_distance(field_.beyond(pin, p_B.x(), p_B.y()), p_B.z() - q[pin]);
      const double lack = to_pin.distance - margin;
      add(weight, lack * lack, pin, lack, to_pin.by_height);
    }
  }
  hessian = gauss_newton;
  return sum;
}

double PinSurface::least_distance(const Kinematics& /*by*/, const Configuration& q,
                                  const SurfaceSamples& samples) const {
  const double highest = q.maxCoeff();
  double least = kInfinity;
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    const Vector3 p_B = field_.in_mount({samples.x[i], samples.y[i], samples.z[i]});
    if (p_B.z() - highest >= least) continue;
    least = nearest_pin(q, p_B, least).distance;
  }
  return least;
}

Pose PinSurface::pose(const Kinematics& by, const Configuration& /*q*/) const { return by.mount(); }

void PinSurface::solid_pieces(const Kinematics& by, const Configuration& q,
                              std::span<SolidPiece> pieces) const {
  // As long as what may stick out of the array, and twice the radius more.
  const double half = 0.5 * geometry_.stroke + geometry_.pin_radius;
  for (int pin = 0; pin < field_.count(); ++pin) {
    pieces[static_cast<std::size_t>(pin)] = {
        RoundedCylinder{geometry_.pin_radius, half, geometry_.pin_edge_radius},
        by.mount() *
            Pose{Matrix3::Identity(), Vector3(field_.x(pin), field_.y(pin), q[pin] - half)}};
  }
}

}  // namespace softfinger
