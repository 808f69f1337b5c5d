#include <array>
#include <limits>

#include "softfinger/device/mechanism/mechanism.hpp"

namespace softfinger {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

Vector3 in_frame(const Pose& X_BS, const Vector3& p_B) {
  return X_BS.rotation.transpose() * (p_B - X_BS.translation);
}

}  // namespace

// Seen from the base frame B', a body with origin o, velocity v and angular velocity w carries the
// point y with u = v + w x r, r = y - o; a function of the point in the body's frame with gradient
// g (in B') then changes at the rate -g . u. Sums over the samples of one body, by v and w:
struct Mechanism::BodySums {
  bool touched = false;
  Twist by_q;                           ///< of the body
  Vector3 force = Vector3::Zero();      ///< sum g
  Matrix3 force_arm = Matrix3::Zero();  ///< sum g r^T
  Matrix6 gauss_newton = Matrix6::Zero();
  Matrix6 curvature = Matrix6::Zero();  ///< exact, but for the bending of the motion

  void add(const Vector3& g, const Vector3& arm, const Matrix3& straight, const Matrix3& exact) {
    touched = true;
    force += g;
    force_arm += g * arm.transpose();
    add_by_twist(straight, arm, gauss_newton);
    add_by_twist(exact, arm, curvature);
  }
  /// sum r x g.
  [[nodiscard]] Vector3 moment() const {
    const Matrix3& k = force_arm;
    return {k(2, 1) - k(1, 2), k(0, 2) - k(2, 0), k(1, 0) - k(0, 1)};
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

void Mechanism::place_pieces(const LinkageSolution& solution, PiecePoses& poses) const {
  for (std::size_t k = 0; k < description_.surface.size(); ++k) {
    poses[k] = piece_pose(solution, description_.surface[k]);
  }
}

std::size_t Mechanism::nearest_face(const PiecePoses& poses, const Vector3& p_B) const {
  const std::vector<SurfacePiece>& surface = description_.surface;
  std::size_t nearest = 0;
  if (surface.size() == 1) return nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < surface.size(); ++k) {
    const double square = squared_face_distance(surface[k].shape, in_frame(poses[k], p_B));
    if (square < least) {
      least = square;
      nearest = k;
    }
  }
  return nearest;
}

std::size_t Mechanism::nearest_solid(const PiecePoses& poses, const Vector3& p_B) const {
  const std::vector<SurfacePiece>& surface = description_.surface;
  std::size_t nearest = 0;
  if (surface.size() == 1) return nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < surface.size(); ++k) {
    const double distance = solid_distance(surface[k].shape, in_frame(poses[k], p_B)).distance;
    if (distance < least) {
      least = distance;
      nearest = k;
    }
  }
  return nearest;
}

ClosestPointResidual Mechanism::closest_point_residual(const Configuration& q,
                                                       const Vector3& p_F) const {
  LinkageSolution solution;
  static_cast<void>(solve(q, solution));
  const Vector3 p_B = settings().X_FB.rotation.transpose() * (p_F - settings().X_FB.translation);
  PiecePoses poses;
  place_pieces(solution, poses);
  const std::size_t k = nearest_face(poses, p_B);
  const SurfacePiece& piece = description_.surface[k];
  const Pose& X_BS = poses[k];
  const NearestPoint nearest = nearest_point(piece.shape, in_frame(X_BS, p_B));
  const auto body = static_cast<std::size_t>(piece.body);
  const Matrix3 turn = skew(p_B - solution.placement.body[body].translation);
  const Twist by_q = twist(solution, piece.body);
  ClosestPointResidual answer;
  answer.residual = nearest.residual;
  answer.jacobian = -nearest.derivative * X_BS.rotation.transpose() *
                    (by_q.topRows<3>() - turn * by_q.bottomRows<3>());
  return answer;
}

SurfaceDistance Mechanism::signed_distance(const Configuration& q, const Vector3& p_F) const {
  LinkageSolution solution;
  static_cast<void>(solve(q, solution));
  const Vector3 p_B = settings().X_FB.rotation.transpose() * (p_F - settings().X_FB.translation);
  PiecePoses poses;
  place_pieces(solution, poses);
  const std::size_t k = nearest_solid(poses, p_B);
  const SurfacePiece& piece = description_.surface[k];
  const Pose& X_BS = poses[k];
  const SignedDistance solid = solid_distance(piece.shape, in_frame(X_BS, p_B));
  const Vector3 g = X_BS.rotation * solid.gradient;
  const auto body = static_cast<std::size_t>(piece.body);
  const Vector3 arm = p_B - solution.placement.body[body].translation;
  const Twist by_q = twist(solution, piece.body);
  SurfaceDistance answer;
  answer.distance = solid.distance;
  answer.gradient =
      -by_q.topRows<3>().transpose() * g - by_q.bottomRows<3>().transpose() * arm.cross(g);
  return answer;
}

double Mechanism::deviation(const Configuration& q, const SurfaceSamples& samples) const {
  LinkageSolution solution;
  static_cast<void>(solve(q, solution));
  PiecePoses poses;
  place_pieces(solution, poses);
  const Pose X_BF = settings().X_FB.inverse();
  double sum = 0.0;
  for (int i = 0; i < samples.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    const Vector3 p_B = X_BF * Vector3(samples.x[s], samples.y[s], samples.z[s]);
    const bool touches = i < samples.contact_count;
    const std::size_t k = touches ? nearest_face(poses, p_B) : nearest_solid(poses, p_B);
    const PieceShape& shape = description_.surface[k].shape;
    const Vector3 p_S = in_frame(poses[k], p_B);
    if (touches) {
      sum += samples.weight[s] * squared_face_distance(shape, p_S);
    } else {
      const double lack = solid_distance(shape, p_S).distance - samples.margin[s];
      if (lack < 0.0) sum += samples.weight[s] * lack * lack;
    }
  }
  return sum;
}

double Mechanism::deviation_derivatives(const Configuration& q, const SurfaceSamples& samples,
                                        Eigen::Ref<Eigen::VectorXd> gradient,
                                        Eigen::Ref<Eigen::MatrixXd> gauss_newton,
                                        Eigen::Ref<Eigen::MatrixXd> hessian) const {
  LinkageSolution solution;
  static_cast<void>(solve(q, solution));
  PiecePoses poses;
  place_pieces(solution, poses);
  const Pose X_BF = settings().X_FB.inverse();
  std::array<BodySums, kMaxLinkageBodies> sums;
  double value = 0.0;
  for (int i = 0; i < samples.size(); ++i) {
    const auto s = static_cast<std::size_t>(i);
    const Vector3 p_B = X_BF * Vector3(samples.x[s], samples.y[s], samples.z[s]);
    const double w = samples.weight[s];
    const bool touches = i < samples.contact_count;
    const std::size_t k = touches ? nearest_face(poses, p_B) : nearest_solid(poses, p_B);
    const SurfacePiece& piece = description_.surface[k];
    const Matrix3& R = poses[k].rotation;
    const auto body = static_cast<std::size_t>(piece.body);
    const Vector3 arm = p_B - solution.placement.body[body].translation;
    const Vector3 p_S = in_frame(poses[k], p_B);
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
  for (int b = 0; b < description_.linkage.linkage().body_count(); ++b) {
    BodySums& sum = sums[static_cast<std::size_t>(b)];
    if (!sum.touched) continue;
    sum.by_q = twist(solution, b);
    const Twist& by_q = sum.by_q;
    gradient -=
        by_q.topRows<3>().transpose() * sum.force + by_q.bottomRows<3>().transpose() * sum.moment();
    const Twist straight = sum.gauss_newton * by_q;
    const Twist bent = sum.curvature * by_q;
    gauss_newton += by_q.transpose() * straight;
    hessian += by_q.transpose() * bent;
  }
  add_motion_curvature(solution, sums, hessian);
  return value;
}

// How the velocities u themselves change with q: -g . du/dq, of which du/dq has a part by the
// coordinates' second derivatives, A d2x/dq2 = -(dA/dq) dx/dq, contracted by the transposed
// factors, and one by the bodies' motion.
void Mechanism::add_motion_curvature(const LinkageSolution& solution,
                                     const std::array<BodySums, kMaxLinkageBodies>& sums,
                                     Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const Linkage& linkage = description_.linkage.linkage();
  const int n = degrees_of_freedom();
  LinkageCoordinates weight = LinkageCoordinates::Zero(linkage.coordinate_count());
  for (int b = 0; b < linkage.body_count(); ++b) {
    const auto body = static_cast<std::size_t>(b);
    if (!sums[body].touched) continue;
    const Vector3 moment = sums[body].moment();
    for (int j = 0; j < linkage.coordinate_count(); ++j) {
      if (!linkage.moves(j, b)) continue;
      const Vector3 shift =
          linkage.point_velocity(j, solution.placement, solution.placement.body[body].translation);
      weight[j] -= sums[body].force.dot(shift);
      if (linkage.is_angle(j)) {
        weight[j] -= moment.dot(solution.placement.direction[static_cast<std::size_t>(j)]);
      }
    }
  }
  solution.lu.solve_transposed(weight);

  LinkageVelocity velocity;
  LinkageMatrix rates;
  for (int l = 0; l < n; ++l) {
    motion(solution, l, velocity, rates);
    LinkageCoordinates bend = -rates.transpose() * weight;
    for (int b = 0; b < linkage.body_count(); ++b) {
      const auto body = static_cast<std::size_t>(b);
      const BodySums& sum = sums[body];
      if (!sum.touched) continue;
      const Vector3 moment = sum.moment();
      for (int j = 0; j < linkage.coordinate_count(); ++j) {
        if (!linkage.moves(j, b)) continue;
        bend[j] -= sum.force.dot(linkage.point_velocity_rate(
            j, solution.placement, velocity, solution.placement.body[body].translation,
            velocity.velocity[body]));
        if (linkage.is_angle(j)) {
          bend[j] -= moment.dot(velocity.direction_rate[static_cast<std::size_t>(j)]);
        }
      }
      const Twist& by_q = sum.by_q;
      const Vector3& v = velocity.velocity[body];
      const Vector3& spin = velocity.spin[body];
      const double trace = sum.force_arm.trace();
      // g . (w_l x v_k + w_k x v_l + w_l x (w_k x r)), summed.
      hessian.col(l) += by_q.topRows<3>().transpose() * sum.force.cross(spin) +
                        by_q.bottomRows<3>().transpose() *
                            (v.cross(sum.force) + sum.force_arm * spin - trace * spin);
    }
    hessian.col(l) += solution.by_value.transpose() * bend;
  }
}

double Mechanism::least_distance(const Configuration& q, const SurfaceSamples& samples) const {
  LinkageSolution solution;
  static_cast<void>(solve(q, solution));
  const Pose X_BF = settings().X_FB.inverse();
  double least = std::numeric_limits<double>::infinity();
  for (const SurfacePiece& piece : description_.surface) {
    const Pose X_SF = piece_pose(solution, piece).inverse() * X_BF;
    for (std::size_t i = 0; i < samples.x.size(); ++i) {
      const Vector3 p_S = X_SF * Vector3(samples.x[i], samples.y[i], samples.z[i]);
      least = std::min(least, solid_distance(piece.shape, p_S).distance);
    }
  }
  return least;
}

}  // namespace softfinger
