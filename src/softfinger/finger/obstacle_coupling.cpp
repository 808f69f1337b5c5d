#include "softfinger/finger/obstacle_coupling.hpp"

#include <algorithm>

namespace softfinger {

void ObstacleCoupling::clear() {
  touches = true;
  by_obstacle.setZero();
  std::fill(by_point.begin(), by_point.end(), Matrix36::Zero());
  for (std::vector<double>& column : columns) std::fill(column.begin(), column.end(), 0.0);
}

void ObstacleCoupling::add(std::size_t point, const Vector3& r, const Vector3& g, const Matrix3& K,
                           bool with_turning) {
  const Matrix3 arm = skew(r);
  Matrix36& by_pose = by_point[point];
  by_pose.leftCols<3>() = -K;
  by_pose.rightCols<3>() = K * arm;
  by_obstacle.topLeftCorner<3, 3>() += K;
  by_obstacle.bottomRightCorner<3, 3>() -= arm * K * arm;
  if (with_turning) {
    by_pose.rightCols<3>() -= skew(g);
    by_obstacle.bottomRightCorner<3, 3>() +=
        0.5 * (g * r.transpose() + r * g.transpose()) - g.dot(r) * Matrix3::Identity();
  }
  by_obstacle.topRightCorner<3, 3>() -= by_pose.rightCols<3>();
  by_obstacle.bottomLeftCorner<3, 3>() -= by_pose.rightCols<3>().transpose();
}

}  // namespace softfinger
