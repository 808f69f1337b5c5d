#include "softfinger/objectives/shear_directions.hpp"

#include <Eigen/Eigenvalues>
#include <limits>
#include <vector>

#include "softfinger/twin/piece_motion.hpp"

namespace softfinger {
namespace {

/// A direction counts in which the surface goes at least this part of what the axes' metric says.
constexpr double kLeastShear = 0.5;

/// Where the surface of a piece is nearest to the resting skin, in F.
struct NearestPlace {
  Vector3 point, outward;
  double gap;
};

NearestPlace nearest_place(const FingerModel& model, const SolidPiece& piece) {
  const Pose X_SF = piece.X_FS.inverse();
  NearestPlace place{piece.X_FS.translation, Vector3::UnitZ(),
                     std::numeric_limits<double>::infinity()};
  for (const int node : model.sample_nodes) {
    const Vector3& p_F = model.mesh.nodes[static_cast<std::size_t>(node)];
    const SignedDistance at = distance_and_gradient(piece.shape, X_SF * p_F);
    if (at.distance >= place.gap) continue;
    const Vector3 outward = piece.X_FS.rotation * at.gradient;
    place = {p_F - at.distance * outward, outward.stableNormalized(), at.distance};
  }
  return place;
}

}  // namespace

Matrix3 shear_projection(const FingerModel& model, const Device& device) {
  const int dof = device.degrees_of_freedom();
  std::vector<SolidPiece> pieces(static_cast<std::size_t>(device.solid_piece_count()));
  device.solid_pieces(device.home(), pieces);
  PieceMotions motions(device);
  motions.at(device.home());
  Matrix3 along = Matrix3::Zero();
  NearestPlace nearest{{}, Vector3::UnitZ(), std::numeric_limits<double>::infinity()};
  for (std::size_t piece = 0; piece < pieces.size(); ++piece) {
    const NearestPlace place = nearest_place(model, pieces[piece]);
    SurfaceJacobian moved(3, dof);
    for (int k = 0; k < dof; ++k) {
      moved.col(k) = motions(piece, k).at(place.point, place.outward) /
                     device.axes()[static_cast<std::size_t>(k)].metric;
    }
    const Eigen::RowVectorXd advance = place.outward.transpose() * moved;
    moved -= place.outward * advance;
    // What is left to the axes together where they do not advance the surface.
    if (advance.squaredNorm() > 0.0) {
      moved -= moved * advance.transpose() * advance / advance.squaredNorm();
    }
    along += moved * moved.transpose();
    if (place.gap < nearest.gap) nearest = place;
  }
  // A flank's own plane leads towards the finger as well.
  const Matrix3 aside = Matrix3::Identity() - nearest.outward * nearest.outward.transpose();
  along = (aside * along * aside).eval();
  const Eigen::SelfAdjointEigenSolver<Matrix3> directions(along);
  Matrix3 projection = Matrix3::Zero();
  for (int k = 0; k < 3; ++k) {
    if (directions.eigenvalues()[k] < kLeastShear * kLeastShear) continue;
    projection += directions.eigenvectors().col(k) * directions.eigenvectors().col(k).transpose();
  }
  return projection;
}

}  // namespace softfinger
