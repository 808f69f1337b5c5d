#include "softfinger/twin/piece_motion.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

constexpr double kStep = 1e-6;  // m of surface motion

double ball_radius(const Shape& shape) {
  const auto* ball = std::get_if<Ball>(&shape);
  return ball != nullptr ? ball->radius : 0.0;
}

}  // namespace

PieceMotions::PieceMotions(const Device& device)
    : device_(device),
      forward_(static_cast<std::size_t>(device.solid_piece_count())),
      backward_(forward_),
      motions_(forward_.size() * static_cast<std::size_t>(device.degrees_of_freedom())),
      moves_(motions_.size(), 1) {
  if (forward_.size() < 2) return;
  at(device.home());
  for (std::size_t i = 0; i < moves_.size(); ++i) moves_[i] = motions_[i].moves() ? 1 : 0;
}

void PieceMotions::at(const Configuration& q) {
  const int dof = device_.degrees_of_freedom();
  Configuration moved = q;
  for (int k = 0; k < dof; ++k) {
    const double step = kStep / device_.axes()[static_cast<std::size_t>(k)].metric;
    moved[k] = q[k] + step;
    device_.solid_pieces(moved, forward_);
    moved[k] = q[k] - step;
    device_.solid_pieces(moved, backward_);
    moved[k] = q[k];
    const double rate = 0.5 / step;
    for (std::size_t piece = 0; piece < forward_.size(); ++piece) {
      const Pose& a = backward_[piece].X_FS;
      const Pose& b = forward_[piece].X_FS;
      PieceMotion& motion = motions_[place(piece, k)];
      motion.origin = 0.5 * (a.translation + b.translation);
      motion.velocity = rate * (b.translation - a.translation);
      // Of so small a turn the antisymmetric part is the rotation vector to 1e-12.
      const Matrix3 turn = b.rotation * a.rotation.transpose();
      motion.spin =
          0.5 * rate *
          Vector3(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
      motion.growth =
          rate * (ball_radius(forward_[piece].shape) - ball_radius(backward_[piece].shape));
    }
  }
}

double PieceMotions::longest(const Configuration& from, const Configuration& to) const {
  double longest = 0.0;
  for (std::size_t piece = 0; piece < forward_.size(); ++piece) {
    double squared = 0.0;
    for (int k = 0; k < device_.degrees_of_freedom(); ++k) {
      if (moves_[place(piece, k)] == 0) continue;
      const double way = device_.axes()[static_cast<std::size_t>(k)].metric * (to[k] - from[k]);
      squared += way * way;
    }
    longest = std::max(longest, squared);
  }
  return std::sqrt(longest);
}

}  // namespace softfinger
