#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "kinds.hpp"
#include "softfinger/device/linear_drives.hpp"
#include "softfinger/device/surfaces/exact_disk.hpp"
#include "softfinger/device/surfaces/piece_surface.hpp"
#include "thimble.hpp"

namespace softfinger {
namespace {

constexpr double kRadius = 6.0 * mm;
constexpr double kEdge = 0.5 * mm;

/// Skin samples about the pad, the first 20 in contact.
struct DrawnSamples {
  explicit DrawnSamples(std::mt19937& random) {
    std::uniform_real_distribution<double> some(0.5, 2.0);
    for (std::size_t i = 0; i < kCount; ++i) {
      const Vector3 p_F = random_pad_point(random);
      x[i] = p_F.x();
      y[i] = p_F.y();
      z[i] = p_F.z();
      weight[i] = some(random);
      margin[i] = 0.2 * mm * some(random);
    }
  }
  [[nodiscard]] SurfaceSamples view() const { return {x, y, z, weight, margin, 20}; }

  static constexpr std::size_t kCount = 60;
  std::vector<double> x = std::vector<double>(kCount), y = x, z = x, weight = x, margin = x;
};

std::unique_ptr<const ContactingSurface> disk_of_pieces(double radius, double edge) {
  SurfacePiece piece;
  piece.shape = DiskPiece{radius, edge};
  return std::make_unique<const PieceSurface>(std::vector<SurfacePiece>{piece});
}

void expect_alike(const Device& a, const Device& b, const Configuration& q,
                  const SurfaceSamples& samples) {
  const Eigen::Index n = q.size();
  Eigen::VectorXd gradient_a(n), gradient_b(n);
  Eigen::MatrixXd gauss_a(n, n), gauss_b(n, n), hessian_a(n, n), hessian_b(n, n);
  const double value_a = a.deviation_derivatives(q, samples, gradient_a, gauss_a, hessian_a);
  const double value_b = b.deviation_derivatives(q, samples, gradient_b, gauss_b, hessian_b);
  EXPECT_NEAR(value_a, value_b, 1e-9 * value_a);
  EXPECT_NEAR(a.deviation(q, samples), b.deviation(q, samples), 1e-9 * value_a);
  EXPECT_LT((gradient_a - gradient_b).norm(), 1e-9 * gradient_a.norm());
  EXPECT_LT((gauss_a - gauss_b).norm(), 1e-9 * gauss_a.norm());
  EXPECT_LT((hessian_a - hessian_b).norm(), 1e-8 * hessian_a.norm());
  EXPECT_NEAR(a.least_distance(q, samples), b.least_distance(q, samples), 1e-12);
}

// What several bodies can do one body does as well: the thimble's legs under a disk of pieces.
TEST(Composition, LegsCarryPiecesAsTheirDisk) {
  const DeviceSettings settings = thimble().settings();
  const Platform3rrsGeometry& geometry = thimble_legs().geometry();
  const Device pieces(settings, std::make_unique<const Platform3rrs>(settings, geometry),
                      disk_of_pieces(geometry.disk_radius, geometry.disk_edge_radius));
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    expect_alike(thimble(), pieces, random_reachable(random), DrawnSamples(random).view());
  }
}

/// A disk moved by drives along two directions that are not those of its own axes.
TEST(Composition, DrivesCarryEitherDisk) {
  DeviceSettings settings;
  settings.axes = {ConfigurationAxis::length("aside_mm", -5.0 * mm, 5.0 * mm),
                   ConfigurationAxis::length("travel_mm", -3.0 * mm, 7.0 * mm)};
  settings.X_FB = {exp_rotation(Vector3(0.1, -0.2, 0.05)), Vector3(0.0, 0.0, -9.0 * mm)};
  settings.home = Configuration::Zero(2);
  settings.retracted = settings.home;
  LinearDrives::set_joint_limits(settings, 50.0 * mm);
  const std::vector<Vector3> directions{Vector3(0.8, 0.6, 0.0), Vector3(0.0, 0.6, 0.8)};
  const Device disk(settings, std::make_unique<const LinearDrives>(settings, directions, 1),
                    std::make_unique<const ExactDisk>(kRadius, kEdge));
  const Device pieces(settings, std::make_unique<const LinearDrives>(settings, directions, 1),
                      disk_of_pieces(kRadius, kEdge));
  std::mt19937 random(2);
  for (int i = 0; i < 300; ++i) {
    const Configuration q = random_configuration(disk, random);
    expect_alike(disk, pieces, q, DrawnSamples(random).view());
    const Vector3 p_F = random_pad_point(random);
    const ClosestPointResidual a = disk.closest_point_residual(q, p_F);
    const ClosestPointResidual b = pieces.closest_point_residual(q, p_F);
    EXPECT_LT((a.residual - b.residual).norm(), 1e-12);
    EXPECT_LT((a.jacobian - b.jacobian).norm(), 1e-9);
  }
}

/// Pieces of every shape, strewn about the pad, on one drive.
std::vector<SurfacePiece> strewn_pieces(std::mt19937& random) {
  std::uniform_real_distribution<double> some(-1.0, 1.0);
  const std::vector<PieceShape> shapes{DiskPiece{kRadius, kEdge}, PinPiece{0.5 * mm},
                                       Shape{Ball{1.5 * mm}},
                                       Shape{RoundedBox{Vector3(3.0, 0.5, 1.0) * mm, 0.2 * mm}},
                                       Shape{RoundedCylinder{0.5 * mm, 4.0 * mm, 0.1 * mm}}};
  std::vector<SurfacePiece> pieces;
  for (int i = 0; i < 20; ++i) {
    SurfacePiece piece;
    piece.shape = shapes[static_cast<std::size_t>(i) % shapes.size()];
    piece.X_LS = {exp_rotation(Vector3(some(random), some(random), some(random))),
                  8.0 * mm * Vector3(some(random), some(random), some(random))};
    pieces.push_back(piece);
  }
  return pieces;
}

// Most pieces are not looked at: none of those is the nearest.
TEST(Composition, ManyPiecesAreAsNearAsTheNearestOfThem) {
  DeviceSettings settings;
  settings.axes = {ConfigurationAxis::length("travel_mm", -3.0 * mm, 7.0 * mm)};
  settings.home = Configuration::Zero(1);
  settings.retracted = settings.home;
  LinearDrives::set_joint_limits(settings, 50.0 * mm);
  std::mt19937 random(3);
  for (int trial = 0; trial < 10; ++trial) {
    const std::vector<SurfacePiece> pieces = strewn_pieces(random);
    const Device device(
        settings,
        std::make_unique<const LinearDrives>(settings, std::vector<Vector3>{Vector3::UnitZ()}, 1),
        std::make_unique<const PieceSurface>(pieces));
    const Configuration q = random_configuration(device, random);
    std::vector<double> x, y, z;
    double least_of_all = 1.0;
    for (int i = 0; i < 100; ++i) {
      const Vector3 p_F = random_pad_point(random);
      double solid = 1.0;
      double face = 1.0;
      for (const SurfacePiece& piece : pieces) {
        const Vector3 p_S = piece.X_LS.inverse() * (p_F - q[0] * Vector3::UnitZ());
        solid = std::min(solid, solid_distance(piece.shape, p_S).distance);
        face = std::min(face, squared_face_distance(piece.shape, p_S));
      }
      EXPECT_NEAR(device.signed_distance(q, p_F).distance, solid, 1e-14);
      EXPECT_NEAR(device.closest_point_residual(q, p_F).residual.squaredNorm(), face, 1e-14);
      least_of_all = std::min(least_of_all, solid);
      x.push_back(p_F.x());
      y.push_back(p_F.y());
      z.push_back(p_F.z());
      const SurfaceSamples so_far{x, y, z, x, x, 0};
      EXPECT_NEAR(device.least_distance(q, so_far), least_of_all, 1e-14);
    }
  }
}

}  // namespace
}  // namespace softfinger
