#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix36 = Eigen::Matrix<double, 3, 6>;

/// How a factored finger, with the matrix A, and one obstacle that moves depend on each other
/// through contact: second derivatives by the finger's unknowns and by the obstacle's pose, its
/// translation (m) and its rotation about O's origin (rad), in W.
///
/// Each pair's energy, friction included, depends only on y = R^T (x - c), where the point x is in
/// O. With g = dE/dx, K = d2E/dx2 and r = x - c: E_xc = -K, E_x,theta = K [r]x - [g]x, E_cc = K,
/// E_c,theta = -E_x,theta, E_theta,theta = [r]x^T K [r]x + (g r^T + r g^T) / 2 - (g . r) I.
struct ObstacleCoupling {
  bool touches = false;  ///< else nothing below holds
  Matrix6 by_obstacle = Matrix6::Zero();
  std::vector<Matrix36> by_point;                ///< by each contact point and the pose
  std::array<std::vector<double>, 6> columns;    ///< B, by the unknowns and each of the pose
  std::array<std::vector<double>, 6> responses;  ///< A^-1 B

  /// They touch, and nothing is added up yet.
  void clear();
  /// `with_turning`: of g, which may be indefinite.
  void add(std::size_t point, const Vector3& r, const Vector3& g, const Matrix3& K,
           bool with_turning);
};

}  // namespace softfinger
