#pragma once

#include <Eigen/Core>

#include "softfinger/device/device.hpp"
#include "softfinger/matching/contact_surface_matching.hpp"
#include "softfinger/numerics/quadratic_program.hpp"

namespace softfinger {

/// Levenberg-Marquardt (Levenberg, Quarterly Appl. Math. 1944; Marquardt, SIAM J. Appl. Math. 1963)
/// on the residuals of the contact surface deviation, with their exact Jacobian, from one start,
/// without limits: the minimum that is nearest, no more. The variables are metric * q, m of surface
/// motion. Allocates only in the constructor.
class LevenbergMarquardt {
 public:
  struct Outcome {
    Configuration q;
    double deviation = 0.0;  ///< E there, m^2
    int iterations = 0;      ///< steps tried
    Termination termination = Termination::kConverged;
  };

  /// `device` outlives this.
  explicit LevenbergMarquardt(const Device& device);

  [[nodiscard]] Outcome minimise(const SurfaceSamples& samples, const Configuration& start);

 private:
  void expand(const Configuration& q, const SurfaceSamples& samples);
  [[nodiscard]] bool form_step(double damping);

  const Device& device_;
  Eigen::VectorXd metric_, gradient_;
  Eigen::MatrixXd gauss_newton_, hessian_, matrix_;
  QuadraticProgram program_;
};

}  // namespace softfinger
