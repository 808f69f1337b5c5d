#include "softfinger/device/surfaces/piece_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace softfinger {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

Vector3 in_frame(const Pose& X_BS, const Vector3& p_B) {
  return X_BS.rotation.transpose() * (p_B - X_BS.translation);
}

/// Whether what reaches so far about its origin is farther than `distance` from p_S, without a
/// doubt: so most pieces need not be looked at.
bool is_farther(const Vector3& p_S, double reach, double distance) {
  constexpr double kBeyondDoubt = 1e-9;  // m
  const double within = distance + reach + kBeyondDoubt;
  return within < 0.0 || p_S.squaredNorm() > within * within;
}

}  // namespace

// Seen from the base frame B', a body with origin o, velocity v and angular velocity w carries the
// point y with u = v + w x r, r = y - o; a function of the point in the body's frame with gradient
// g (in B') then changes at the rate -g . u. Sums over the samples of one body, by v and w:
struct PieceSurface::BodySums {
  BodyLoad load;
  Matrix6 gauss_newton = Matrix6::Zero();
  Matrix6 curvature = Matrix6::Zero();  ///< exact, but for the bending of the motion

  void add(const Vector3& g, const Vector3& arm, const Matrix3& straight, const Matrix3& exact) {
    load.touched = true;
    load.force += g;
    load.force_arm += g * arm.transpose();
    add_by_twist(straight, arm, gauss_newton);
    add_by_twist(exact, arm, curvature);
  }

 private:
  /// sum += P^T matrix P with P = [I, -[r]], the velocity u by (v, w).
  static void add_by_twist(const Matrix3& matrix, const Vector3& arm, Matrix6& sum) {
    const Matrix3 turn = skew(arm);
    const Matrix3 mixed = -matrix * turn;
    sum.topLeftCorner<3, 3>() += matrix;
    sum.topRightCorner<3, 3>() += mixed;
    sum.bottomLeftCorner<3, 3>() += mixed.transpose();
    sum.bottomRightCorner<3, 3>() += turn * mixed;
  }
};

PieceSurface::PieceSurface(std::vector<SurfacePiece> pieces) : pieces_(std::move(pieces)) {
  for (const SurfacePiece& piece : pieces_) {
    bodies_ = std::max(bodies_, static_cast<std::size_t>(piece.body) + 1);
    face_reach_.push_back(face_reach(piece.shape));
    solid_reach_.push_back(solid_reach(piece.shape));
  }
}

PieceSurface::Placed PieceSurface::placed(const Kinematics& by, const Configuration& q) const {
  Placed placed;
  by.place(q, std::span(placed.bodies).first(bodies_));
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    placed.pieces[k] = piece_pose(placed, pieces_[k]);
  }
  return placed;
}

Pose PieceSurface::piece_pose(const Placed& placed, const SurfacePiece& piece) {
  return placed.bodies[static_cast<std::size_t>(piece.body)] * piece.X_LS;
}

std::size_t PieceSurface::nearest_face(const Placed& placed, const Vector3& p_B) const {
  std::size_t nearest = 0;
  if (pieces_.size() == 1) return nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    const Vector3 p_S = in_frame(placed.pieces[k], p_B);
    if (is_farther(p_S, face_reach_[k], std::sqrt(least))) continue;
    const double square = squared_face_distance(pieces_[k].shape, p_S);
    if (square < least) {
      least = square;
      nearest = k;
    }
  }
  return nearest;
}

std::size_t PieceSurface::nearest_solid(const Placed& placed, const Vector3& p_B) const {
  std::size_t nearest = 0;
  if (pieces_.size() == 1) return nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    const Vector3 p_S = in_frame(placed.pieces[k], p_B);
    if (is_farther(p_S, solid_reach_[k], least)) continue;
    const double distance = solid_distance(pieces_[k].shape, p_S).distance;
    if (distance < least) {
      least = distance;
      nearest = k;
    }
  }
  return nearest;
}

ClosestPointResidual PieceSurface::closest_point_residual(const Kinematics& by,
                                                          const Configuration& q,
                                                          const Vector3& p_F) const {
  const Vector3 p_B = by.mount().rotation.transpose() * (p_F - by.mount().translation);
  const Placed here = placed(by, q);
  const std::size_t k = nearest_face(here, p_B);
  const SurfacePiece& piece = pieces_[k];
  const Pose& X_BS = here.pieces[k];
  const NearestPoint nearest = nearest_point(piece.shape, in_frame(X_BS, p_B));
  const auto body = static_cast<std::size_t>(piece.body);
  const Matrix3 turn = skew(p_B - here.bodies[body].translation);
  const BodyTwist by_q = by.twist(q, piece.body);
  ClosestPointResidual answer;
  answer.residual = nearest.residual;
  answer.jacobian = -nearest.derivative * X_BS.rotation.transpose() *
                    (by_q.topRows<3>() - turn * by_q.bottomRows<3>());
  return answer;
}

SurfaceDistance PieceSurface::signed_distance(const Kinematics& by, const Configuration& q,
                                              const Vector3& p_F) const {
  const Vector3 p_B = by.mount().rotation.transpose() * (p_F - by.mount().translation);
  const Placed here = placed(by, q);
  const std::size_t k = nearest_solid(here, p_B);
  const SurfacePiece& piece = pieces_[k];
  const Pose& X_BS = here.pieces[k];
  const SignedDistance solid = solid_distance(piece.shape, in_frame(X_BS, p_B));
  const Vector3 g = X_BS.rotation * solid.gradient;
  const auto body = static_cast<std::size_t>(piece.body);
  const Vector3 arm = p_B - here.bodies[body].translation;
  const BodyTwist by_q = by.twist(q, piece.body);
  SurfaceDistance answer;
  answer.distance = solid.distance;
  answer.gradient =
      -by_q.topRows<3>().transpose() * g - by_q.bottomRows<3>().transpose() * arm.cross(g);
  return answer;
}

double PieceSurface::deviation(const Kinematics& by, const Configuration& q,
                               const SurfaceSamples& samples) const {
  const Placed here = placed(by, q);
  const Pose X_BF = by.mount().inverse();
  double sum = 0.0;
  for (int i = 0; i < samples.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    const Vector3 p_B = X_BF * Vector3(samples.x[s], samples.y[s], samples.z[s]);
    const bool touches = i < samples.contact_count;
    const std::size_t k = touches ? nearest_face(here, p_B) : nearest_solid(here, p_B);
    const PieceShape& shape = pieces_[k].shape;
    const Vector3 p_S = in_frame(here.pieces[k], p_B);
    if (touches) {
      sum += samples.weight[s] * squared_face_distance(shape, p_S);
    } else {
      const double lack = solid_distance(shape, p_S).distance - samples.margin[s];
      if (lack < 0.0) sum += samples.weight[s] * lack * lack;
    }
  }
  return sum;
}

double PieceSurface::deviation_derivatives(const Kinematics& by, const Configuration& q,
                                           const SurfaceSamples& samples,
                                           Eigen::Ref<Eigen::VectorXd> gradient,
                                           Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                                           Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const Placed here = placed(by, q);
  const Pose X_BF = by.mount().inverse();
  std::array<BodySums, kMostBodies> sums;
  double value = 0.0;
  for (int i = 0; i < samples.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    const Vector3 p_B = X_BF * Vector3(samples.x[s], samples.y[s], samples.z[s]);
    const double w = samples.weight[s];
    const bool touches = i < samples.contact_count;
    const std::size_t k = touches ? nearest_face(here, p_B) : nearest_solid(here, p_B);
    const SurfacePiece& piece = pieces_[k];
    const Matrix3& R = here.pieces[k].rotation;
    const auto body = static_cast<std::size_t>(piece.body);
    const Vector3 arm = p_B - here.bodies[body].translation;
    const Vector3 p_S = in_frame(here.pieces[k], p_B);
    if (touches) {
      const NearestPoint nearest = nearest_point(piece.shape, p_S);
      value += w * nearest.squared_distance;
      const Matrix3 exact = 2.0 * w * R * nearest.derivative * R.transpose();
      const Matrix3 straight = 0.5 / w * exact * exact;
      sums[body].add(2.0 * w * (R * nearest.gradient), arm, straight, exact);
    } else {
      const SignedDistance solid = solid_distance(piece.shape, p_S);
      const double lack = solid.distance - samples.margin[s];
      if (lack >= 0.0) continue;
      value += w * lack * lack;
      const Vector3 normal = R * solid.gradient;
      const Matrix3 straight = 2.0 * w * normal * normal.transpose();
      const Matrix3 bent = 2.0 * w * lack * R * solid.hessian * R.transpose();
      sums[body].add(2.0 * w * lack * normal, arm, straight, straight + bent);
    }
  }

  gradient.setZero();
  gauss_newton.setZero();
  hessian.setZero();
  std::array<BodyLoad, kMostBodies> loads;
  for (std::size_t b = 0; b < bodies_; ++b) {
    BodySums& sum = sums[b];
    if (!sum.load.touched) continue;
    sum.load.by_q = by.twist(q, static_cast<int>(b));
    const BodyTwist& by_q = sum.load.by_q;
    gradient -= by_q.topRows<3>().transpose() * sum.load.force +
                by_q.bottomRows<3>().transpose() * sum.load.moment();
    const BodyTwist straight = sum.gauss_newton * by_q;
    const BodyTwist bent = sum.curvature * by_q;
    gauss_newton += by_q.transpose() * straight;
    hessian += by_q.transpose() * bent;
    loads[b] = sum.load;
  }
  by.add_motion_curvature(q, std::span(loads).first(bodies_), hessian);
  return value;
}

double PieceSurface::least_distance(const Kinematics& by, const Configuration& q,
                                    const SurfaceSamples& samples) const {
  const Placed here = placed(by, q);
  const Pose X_BF = by.mount().inverse();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    const Pose X_SF = here.pieces[k].inverse() * X_BF;
    for (std::size_t i = 0; i < samples.x.size(); ++i) {
      const Vector3 p_S = X_SF * Vector3(samples.x[i], samples.y[i], samples.z[i]);
      if (is_farther(p_S, solid_reach_[k], least)) continue;
      least = std::min(least, solid_distance(pieces_[k].shape, p_S).distance);
    }
  }
  return least;
}

Pose PieceSurface::pose(const Kinematics& by, const Configuration& q) const {
  return by.mount() * (by.pose(q) * pieces_.front().X_LS);
}

void PieceSurface::solid_pieces(const Kinematics& by, const Configuration& q,
                                std::span<SolidPiece> pieces) const {
  const Placed here = placed(by, q);
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    pieces[k] = solid_piece(pieces_[k].shape, by.mount() * here.pieces[k]);
  }
}

const DiskPiece* PieceSurface::only_disk() const {
  return pieces_.size() == 1 ? std::get_if<DiskPiece>(&pieces_.front().shape) : nullptr;
}

double PieceSurface::disk_radius() const {
  return only_disk() != nullptr ? only_disk()->radius : 0.0;
}

double PieceSurface::disk_edge_radius() const {
  return only_disk() != nullptr ? only_disk()->edge_radius : 0.0;
}

}  // namespace softfinger
