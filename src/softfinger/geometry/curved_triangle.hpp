#pragma once

#include <Eigen/Core>
#include <array>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// A triangle bent to be normal to given directions at its corners: a cubic Bezier patch, whose
/// sides depend on nothing but their two ends, so that neighbours meet. Vlachos, Peters, Boyd,
/// Mitchell, "Curved PN triangles", I3D 2001.
class CurvedTriangle {
 public:
  static constexpr int kControlPoints = 10;
  using ControlPoints = Eigen::Matrix<double, 3, kControlPoints>;
  /// What each control point counts for at some place.
  using Basis = Eigen::Matrix<double, kControlPoints, 1>;

  /// Unit normals at the corners.
  CurvedTriangle(const std::array<Vector3, 3>& corners, const std::array<Vector3, 3>& normals);

  /// At the place with these weights of the corners, which sum to 1.
  [[nodiscard]] static Basis basis(const std::array<double, 3>& weights);
  [[nodiscard]] Vector3 at(const std::array<double, 3>& weights) const {
    return control_points_ * basis(weights);
  }
  /// The corners first. The patch lies in their convex hull.
  [[nodiscard]] const ControlPoints& control_points() const { return control_points_; }

 private:
  /// The corners; of each side, from a corner to the next one, the point near the first and the
  /// point near the second; the middle.
  ControlPoints control_points_;
};

}  // namespace softfinger
