#include "softfinger/matching/contact_plane.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "softfinger/device/surfaces/pin_field.hpp"

namespace softfinger {
namespace {

constexpr int kRounds = 30;
constexpr double kArrived = 1e-10;  // m
constexpr double kSlight = 1e-6;    // of a metre a metre: a length that hardly moves the surface
constexpr double kThin = 1e-3;      // of the greatest spread of points: less is none

/// Pins as high as the plane over their middles.
Configuration pins_on_plane(const Device& device, const PinField& pins, const FittedPlane& plane) {
  const Vector3 point_B = pins.in_mount(plane.point);
  const Vector3 normal_B = pins.in_mount(plane.point + plane.normal) - point_B;
  Configuration q = device.home();
  for (int pin = 0; pin < pins.count(); ++pin) {
    double height = point_B.z();
    if (normal_B.z() > kThin) {
      height -= (normal_B.x() * (pins.x(pin) - point_B.x()) +
                 normal_B.y() * (pins.y(pin) - point_B.y())) /
                normal_B.z();
    }
    const ConfigurationAxis& axis = device.axes()[static_cast<std::size_t>(pin)];
    q[pin] = std::clamp(height, axis.min, axis.max);
  }
  return q;
}

}  // namespace

FittedPlane contact_plane(const ContactPoints& points, MatchingWeights weights,
                          const Device& device) {
  FittedPlane plane;
  double sum = 0.0;
  const auto for_each_contact = [&](auto&& visit) {
    for (std::size_t i = 0; i < points.points_F.size(); ++i) {
      if (points.in_contact[i] == 0) continue;
      const double share = points.shares.empty() ? 1.0 : points.shares[i];
      visit(points.points_F[i],
            share * (weights == MatchingWeights::kArea ? points.areas[i] : 1.0));
    }
  };
  for_each_contact([&](const Vector3& p, double weight) {
    plane.point += weight * p;
    sum += weight;
  });
  if (!(sum > 0.0)) return plane;
  plane.point /= sum;
  Matrix3 spread = Matrix3::Zero();
  for_each_contact([&](const Vector3& p, double weight) {
    spread += weight * (p - plane.point) * (p - plane.point).transpose();
  });
  const Eigen::SelfAdjointEigenSolver<Matrix3> axes(spread);
  // Points on a line, or one alone, leave the plane open.
  if (!(axes.eigenvalues()[1] > kThin * kThin * axes.eigenvalues()[2])) return plane;
  plane.normal = axes.eigenvectors().col(0);
  const Vector3 outward = device.surface_pose(device.home()).rotation.col(2);
  if (plane.normal.dot(outward) < 0.0) plane.normal = -plane.normal;
  return plane;
}

bool takes_plane(const Device& device) {
  return std::ranges::any_of(device.axes(),
                             [](const ConfigurationAxis& axis) { return !axis.angular; });
}

Configuration on_plane(const Device& device, const FittedPlane& plane) {
  if (const PinField* const pins = device.pin_field()) return pins_on_plane(device, *pins, plane);
  Configuration q = device.home();
  if (plane.normal.squaredNorm() > 0.0) q = device.facing(plane.normal, q);
  for (int round = 0; round < kRounds; ++round) {
    const ClosestPointResidual off = device.closest_point_residual(q, plane.point);
    Matrix3 moved = kSlight * Matrix3::Identity();
    for (int k = 0; k < q.size(); ++k) {
      if (device.axes()[static_cast<std::size_t>(k)].angular) continue;
      moved += off.jacobian.col(k) * off.jacobian.col(k).transpose();
    }
    // The least step that takes off to zero, as far as these columns can.
    const Vector3 load = moved.inverse() * off.residual;
    double longest = 0.0;
    for (int k = 0; k < q.size(); ++k) {
      if (device.axes()[static_cast<std::size_t>(k)].angular) continue;
      const double step = -off.jacobian.col(k).dot(load);
      q[k] += step;
      longest = std::max(longest, std::abs(step));
    }
    if (longest < kArrived) break;
  }
  return q;
}

}  // namespace softfinger
