#pragma once

#include <Eigen/Core>

#include "softfinger/device/device.hpp"
#include "softfinger/matching/contact_surface_matching.hpp"
#include "softfinger/numerics/quadratic_program.hpp"

namespace softfinger {

/// Minimises the contact surface deviation from one start. The variables are s = metric * q, so all
/// are metres of surface motion. Where E is flat (one contact, a direction without samples), the
/// minimiser nearest home: a term attraction * |s - s_home|^2 is added and taken almost to zero in
/// stages, so that the way along a curved valley of E is short.
class DeviationMinimiser {
 public:
  struct Outcome {
    Configuration q;
    double deviation = 0.0;  ///< E, m^2
    int iterations = 0;
    Termination termination = Termination::kConverged;
    bool valid = false;  ///< false where no feasible point was found from the start, or known
    bool known = false;  ///< the way led to the minimum known before
    /// Some limit was in the way; else the way without limits is the same to the bit.
    bool limited = false;
  };

  explicit DeviationMinimiser(const Device& device);

  /// `inside`: every iterate within the device's constraints. `known`: a minimum found before; may
  /// be null. A way that leads close to it is not walked to its end, and the outcome is not valid.
  [[nodiscard]] Outcome minimise(const SurfaceSamples& samples, const Configuration& start,
                                 bool inside, int iteration_limit,
                                 const Configuration* known = nullptr);

 private:
  /// E and its derivatives at one q, in the variables s.
  struct Expansion {
    explicit Expansion(int n) : gradient(n), gauss_newton(n, n), hessian(n, n) {}
    double value = 0.0;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd gauss_newton, hessian;
  };
  /// How one stage of attraction ended.
  enum class Stage { kConverged, kIterationLimit, kStalled, kValley, kKnown };

  void expand(const Configuration& q, Expansion& expansion) const;
  [[nodiscard]] double attracted(double deviation, const Configuration& q) const;
  [[nodiscard]] bool evaluate_constraints(const Configuration& q);
  [[nodiscard]] bool restore(Configuration& q);
  [[nodiscard]] bool degenerate(const Eigen::MatrixXd& curvature);
  [[nodiscard]] bool form_direction(const Configuration& q, bool inside, double damping,
                                    bool exact);
  [[nodiscard]] double free_gradient() const;
  Stage descend(Configuration& q, bool inside, int iteration_limit, int& iterations);

  const Device& device_;
  int n_;
  const SurfaceSamples* samples_ = nullptr;
  const Configuration* known_ = nullptr;
  double attraction_ = 0.0;
  bool limited_ = false;      ///< see Outcome
  bool may_be_flat_ = false;  ///< the stages before the last were left out
  Expansion here_, there_;
  Eigen::VectorXd metric_, gradient_, values_, raw_values_;
  Eigen::MatrixXd matrix_, jacobian_, curvature_;
  QuadraticProgram program_, projection_;
  Eigen::VectorXd multipliers_, zero_;
};

}  // namespace softfinger
