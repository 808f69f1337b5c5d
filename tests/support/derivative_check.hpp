#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace softfinger {

/// Largest difference between a Jacobian (m x n) and central differences of `function`, which maps
/// an n-vector to an m-vector, with one step h_k per variable; relative to `scale`, or to the
/// largest entry of the difference quotients where that is greater.
template <typename Function>
[[nodiscard]] double derivative_error(Function&& function, const Eigen::VectorXd& at,
                                      const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& steps,
                                      double scale = 0.0) {
  double worst = 0.0;
  double largest = scale;
  for (Eigen::Index k = 0; k < at.size(); ++k) {
    Eigen::VectorXd forward = at;
    Eigen::VectorXd backward = at;
    forward[k] += steps[k];
    backward[k] -= steps[k];
    const Eigen::VectorXd f = function(forward);
    const Eigen::VectorXd b = function(backward);
    const Eigen::VectorXd column = (f - b) / (forward[k] - backward[k]);
    worst = std::max(worst, (column - jacobian.col(k)).cwiseAbs().maxCoeff());
    largest = std::max(largest, column.cwiseAbs().maxCoeff());
  }
  return largest > 0.0 ? worst / largest : worst;
}

}  // namespace softfinger
