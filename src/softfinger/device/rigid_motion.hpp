#pragma once

#include <array>

#include "softfinger/device/configuration.hpp"
#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// Derivative of a pose by one or two components of q: of the rotation's entries and of the origin.
struct PoseRate {
  Matrix3 rotation = Matrix3::Zero();
  Vector3 translation = Vector3::Zero();
};

/// A body at one q and how it moves with q, in B'; of at most three degrees of freedom.
struct RigidMotion {
  static constexpr int kMostAxes = 3;

  Pose X_BP;
  int count = 0;  ///< degrees of freedom
  std::array<PoseRate, kMostAxes> rate{};
  /// Whether second derivatives are given: bend[k + l] by q_k and q_l, of the first two axes. All
  /// others are zero.
  bool exact = false;
  std::array<PoseRate, kMostAxes> bend{};
};

/// Most bodies that carry a surface, and most degrees of freedom of what moves several.
inline constexpr std::size_t kMostBodies = 25;
inline constexpr int kMostTwistAxes = 12;
/// Twist of a body by q: rows 0-2 velocity of its origin, rows 3-5 angular velocity, in B'.
using BodyTwist = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMostTwistAxes>;

/// What presses on a body, as derivatives g of a function by points r from its origin, in B'.
struct BodyLoad {
  bool touched = false;
  BodyTwist by_q;                       ///< of the body
  Vector3 force = Vector3::Zero();      ///< sum g
  Matrix3 force_arm = Matrix3::Zero();  ///< sum g r^T

  /// sum r x g.
  [[nodiscard]] Vector3 moment() const {
    const Matrix3& k = force_arm;
    return {k(2, 1) - k(1, 2), k(0, 2) - k(2, 0), k(1, 0) - k(0, 1)};
  }
};

}  // namespace softfinger
