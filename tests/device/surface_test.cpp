#include <gtest/gtest.h>

#include "../support/derivative_check.hpp"
#include "softfinger/device/surfaces/disk_geometry.hpp"
#include "thimble.hpp"

namespace softfinger {
namespace {

Vector3 random_point(std::mt19937& random) {
  std::uniform_real_distribution<double> across(-14.0, 14.0);
  std::uniform_real_distribution<double> up(-14.0, 0.0);
  return Vector3(across(random), across(random), up(random)) * mm;
}

TEST(Surface, ClosestPointAgreesWithSearchOverTheDisk) {
  const double radius = 8.0 * mm;
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const Vector3 p = random_point(random);
    double least = 1.0;
    for (int ring = 0; ring <= 200; ++ring) {
      for (int spoke = 0; spoke < 360; ++spoke) {
        const double rho = radius * ring / 200.0;
        const Vector3 at(rho * std::cos(spoke * deg), rho * std::sin(spoke * deg), 0.0);
        least = std::min(least, (p - at).norm());
      }
    }
    EXPECT_NEAR(disk_closest_point_residual(radius, p).norm(), least, 0.05 * mm);
    EXPECT_LE(disk_closest_point_residual(radius, p).norm(), least + 1e-15);
  }
}

TEST(Surface, ConeDistanceAgreesWithSearchOverItsBoundary) {
  const double radius = 8.0 * mm;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> across(-14.0, 14.0);
  std::uniform_real_distribution<double> up(-9.0, 7.0);
  for (int i = 0; i < 500; ++i) {
    const Vector3 p = Vector3(across(random), across(random), up(random)) * mm;
    const double rho = std::hypot(p.x(), p.y());
    double least = 1.0;  // boundary in the meridian plane
    for (int k = 0; k <= 20000; ++k) {
      const double s = k / 20000.0;
      least = std::min(least, std::hypot(rho - s * radius, p.z()));
      least = std::min(least, std::hypot(rho - radius - s * 30.0 * mm, p.z() + s * 30.0 * mm));
    }
    const bool inside = p.z() <= 0.0 && rho <= radius - p.z();
    EXPECT_NEAR(cone_distance(radius, p).distance, inside ? -least : least, 2e-6);
  }
}

TEST(Surface, JacobiansAreDerivatives) {
  std::mt19937 random(3);
  double worst_closest = 0.0;
  double worst_signed = 0.0;
  int compared = 0;
  for (int i = 0; i < 2000; ++i) {
    const Configuration q = random_reachable(random);
    const Vector3 p_F = random_point(random);
    // Differences across a kink or the axis say nothing.
    const Vector3 p_P = thimble().surface_pose(q).inverse() * p_F;
    const double rho = std::hypot(p_P.x(), p_P.y());
    const double u = rho - thimble().disk_radius();
    const double ridge = p_P.z() - (u + p_P.z()) / std::sqrt(2.0);
    if (std::abs(u) < 1e-6 || rho < 1e-4 || std::abs(ridge) < 1e-6 ||
        std::hypot(u, p_P.z()) < 1e-4) {
      continue;
    }
    ++compared;
    const auto residual_at = [&](const Eigen::VectorXd& at) {
      return Eigen::VectorXd(thimble().closest_point_residual(at, p_F).residual);
    };
    // The residual is expressed in P: its Jacobian is that of its components.
    worst_closest =
        std::max(worst_closest,
                 derivative_error(residual_at, q, thimble().closest_point_residual(q, p_F).jacobian,
                                  difference_steps(), 1e-2));
    const auto distance_at = [&](const Eigen::VectorXd& at) {
      return Eigen::VectorXd::Constant(1, thimble().signed_distance(at, p_F).distance).eval();
    };
    worst_signed = std::max(
        worst_signed,
        derivative_error(distance_at, q, thimble().signed_distance(q, p_F).gradient.transpose(),
                         difference_steps(), 1e-2));
  }
  EXPECT_GT(compared, 1900);
  EXPECT_LT(worst_closest, 1e-6);
  EXPECT_LT(worst_signed, 1e-6);
}

// The fast sums against the plain ones, sample by sample, and against differences.
TEST(Surface, DeviationSumsAgreeWithSingleQueries) {
  std::mt19937 random(4);
  constexpr int kCount = 40;
  std::vector<double> x(kCount), y(kCount), z(kCount), w(kCount), margin(kCount);
  std::uniform_real_distribution<double> some(0.5, 2.0);
  double worst_gradient = 0.0;
  double worst_hessian = 0.0;
  for (int trial = 0; trial < 200; ++trial) {
    const Configuration q = random_reachable(random);
    for (std::size_t i = 0; i < kCount; ++i) {
      const Vector3 p = random_point(random);
      x[i] = p.x();
      y[i] = p.y();
      z[i] = p.z();
      w[i] = some(random);
      margin[i] = 0.2 * mm * some(random);
    }
    const SurfaceSamples samples{x, y, z, w, margin, 15};
    Eigen::VectorXd gradient(3);
    Eigen::VectorXd plain_gradient(3);
    Eigen::MatrixXd gauss(3, 3);
    Eigen::MatrixXd plain_gauss(3, 3);
    Eigen::MatrixXd hessian(3, 3);
    Eigen::MatrixXd unused(3, 3);
    const double value = thimble().deviation_derivatives(q, samples, gradient, gauss, hessian);
    const double plain =
        thimble().Device::deviation_derivatives(q, samples, plain_gradient, plain_gauss, unused);
    EXPECT_NEAR(value, plain, 1e-12 * plain);
    EXPECT_NEAR(thimble().deviation(q, samples), plain, 1e-12 * plain);
    EXPECT_NEAR(thimble().Device::deviation(q, samples), plain, 1e-12 * plain);
    EXPECT_LT((gradient - plain_gradient).norm(), 1e-11 * plain_gradient.norm());
    EXPECT_LT((gauss - plain_gauss).norm(), 1e-11 * plain_gauss.norm());
    const auto value_at = [&](const Eigen::VectorXd& at) {
      return Eigen::VectorXd::Constant(1, thimble().deviation(at, samples)).eval();
    };
    const auto gradient_at = [&](const Eigen::VectorXd& at) {
      Eigen::VectorXd g(3);
      Eigen::MatrixXd a(3, 3);
      Eigen::MatrixXd b(3, 3);
      thimble().deviation_derivatives(at, samples, g, a, b);
      return g;
    };
    worst_gradient = std::max(
        worst_gradient, derivative_error(value_at, q, gradient.transpose(), difference_steps()));
    // A sample near a kink spoils a difference of gradients; most trials have none.
    const double error = derivative_error(gradient_at, q, hessian, difference_steps());
    if (error < 1e-3)
      worst_hessian = std::max(worst_hessian, error);
    else
      EXPECT_LT(error, 1.0);
    double least = 1.0;
    for (std::size_t i = 0; i < kCount; ++i) {
      least = std::min(least, thimble().signed_distance(q, {x[i], y[i], z[i]}).distance);
    }
    EXPECT_NEAR(thimble().least_distance(q, samples), least, 1e-15);
  }
  EXPECT_LT(worst_gradient, 1e-6);
  EXPECT_LT(worst_hessian, 1e-5);
}

}  // namespace
}  // namespace softfinger
