#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "softfinger/finger/element_loads.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {

/// Stress of the twin against that of the virtual finger, as a residual r with
///   |r|^2 = w^2 sum V |s_twin - s_virtual|^2 / sum V
/// over soft elements of rest volume V, s all components of Cauchy's stress in F. Allocates only in
/// the constructor.
class StressMatch {
 public:
  /// `weight`: w, m/Pa. `dof`: of the device.
  StressMatch(const std::shared_ptr<const FingerModel>& model, double weight, int dof);

  /// The virtual finger: all nodes in F, m.
  void want(std::span<const Vector3> nodes_F);
  /// |r|^2 at the twin's last attempt, m^2.
  [[nodiscard]] double cost(const Twin& twin);
  /// Residual and Jacobian J by q there, after the twin's force_and_derivative().
  void linearise(const Twin& twin);
  /// gradient += 2 J^T r, gauss_newton += 2 J^T J, of the last linearise().
  void add_to(Eigen::VectorXd& gradient, Eigen::MatrixXd& gauss_newton) const;

 private:
  void evaluate(std::span<const Vector3> positions);

  ElementLoads loads_;
  std::vector<Stress> wanted_, stresses_;
  Eigen::VectorXd scales_, residual_;
  Eigen::MatrixXd jacobian_;
  std::vector<Vector3> moved_;
};

}  // namespace softfinger
