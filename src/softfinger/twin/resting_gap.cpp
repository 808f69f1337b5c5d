#include "softfinger/twin/resting_gap.hpp"

#include <algorithm>

namespace softfinger {

RestingGap::RestingGap(const Device& device, std::span<const Vector3> skin)
    : device_(device), pieces_(static_cast<std::size_t>(device.solid_piece_count())) {
  for (const Vector3& p : skin) {
    x_.push_back(p.x());
    y_.push_back(p.y());
    z_.push_back(p.z());
  }
}

double RestingGap::at(const Configuration& q, double shift, const Vector3& axis_F) {
  std::vector<double> x(x_);
  std::vector<double> y(y_);
  std::vector<double> z(z_);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] += shift * axis_F.x();
    y[i] += shift * axis_F.y();
    z[i] += shift * axis_F.z();
  }
  SurfaceSamples samples;
  samples.x = x;
  samples.y = y;
  samples.z = z;
  double least = device_.least_distance(q, samples);
  device_.solid_pieces(q, pieces_);
  for (const SolidPiece& piece : pieces_) {
    const Pose X_SF = piece.X_FS.inverse();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vector3 p_S = X_SF * Vector3(x[i], y[i], z[i]);
      least = std::min(least, signed_distance(piece.shape, p_S).distance);
    }
  }
  return least;
}

}  // namespace softfinger
