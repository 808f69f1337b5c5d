#pragma once

#include <Eigen/Core>
#include <optional>

#include "softfinger/numerics/small_lu.hpp"

namespace softfinger {

/// What the active constraints, gradients `rows` (m x 3), push with so that least is left of
/// `gradient`: least squares by the normal equations. Empty where the rows depend on each other.
inline std::optional<Eigen::VectorXd> multipliers(const Eigen::MatrixXd& rows,
                                                  const Eigen::Vector3d& gradient) {
  if (rows.rows() > 3) return std::nullopt;
  SmallLu<3> normal;
  if (!normal.factor(rows.lazyProduct(rows.transpose()))) return std::nullopt;
  Eigen::VectorXd push = rows.lazyProduct(-gradient);
  normal.solve(push);
  return push;
}

}  // namespace softfinger
