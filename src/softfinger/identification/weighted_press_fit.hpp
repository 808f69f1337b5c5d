#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "softfinger/identification/finger_fit.hpp"
#include "softfinger/identification/profile_interval.hpp"

namespace softfinger {

/// One set of parameters fitted: where, and how well it agrees.
struct PressEstimate {
  std::vector<FitParameter> parameters;
  FingerConstants constants;
  Eigen::VectorXd x;  ///< of the parameters; Young's modulus as the logarithm of its factor
  std::vector<ConfidenceInterval> intervals;  ///< of x
  ForceNoise noise = ForceNoise::kRelative;
  double force_noise = 0.05;  ///< relative, or as a fraction of the greatest measured force
  double area_noise = 0.05;   ///< relative
  double log_likelihood = 0.0;
  int degrees_of_freedom = 0;
};

/// Least squares of measured forces and areas over the parameters of a simulated press. Weights
/// follow the simulated forces and the noise that the residuals show, pass by pass.
class WeightedPressFit {
 public:
  /// Both must outlive it.
  WeightedPressFit(const FitInput& input, const PressSimulation& simulate);

  /// With the noise asked for, or the likelier of the two; intervals included. Throws
  /// OperationError where the press cannot be simulated at the start.
  [[nodiscard]] PressEstimate estimate(const std::vector<FitParameter>& parameters,
                                       const FingerConstants& start);
  /// The same without intervals and with relative noise: a start for others.
  [[nodiscard]] PressEstimate rough_estimate(const std::vector<FitParameter>& parameters,
                                             const FingerConstants& start);

  /// Simulated press, remembered; null where it cannot be computed.
  const PressCurve* simulated(const FingerConstants& constants);
  [[nodiscard]] int simulations() const { return static_cast<int>(known_.size()); }

  /// Rows of the curve with a depth above 0.
  [[nodiscard]] const std::vector<std::size_t>& rows() const { return rows_; }
  [[nodiscard]] double depth(std::size_t k) const { return input_.curve.first[rows_[k]]; }
  [[nodiscard]] double force(std::size_t k) const { return input_.curve.second[rows_[k]]; }
  [[nodiscard]] double greatest_force() const { return greatest_force_; }

  /// Where a limit never acts: the bounds of min and max on the side of no limit.
  static constexpr double kLeastMin = 0.05, kGreatestMax = 3.0;

 private:
  PressEstimate fit(const std::vector<FitParameter>& parameters, const FingerConstants& start,
                    ForceNoise noise, bool with_intervals);
  [[nodiscard]] LeastSquaresProblem make_problem(const std::vector<FitParameter>& parameters) const;
  [[nodiscard]] Eigen::VectorXd residuals(const PressEstimate& at, const Eigen::VectorXd& x,
                                          const std::vector<double>& spreads);
  [[nodiscard]] double spread(ForceNoise noise, double force) const;
  [[nodiscard]] double log_likelihood(const PressEstimate& at, ForceNoise noise);
  [[nodiscard]] std::size_t area_rows() const;

  const FitInput& input_;
  const PressSimulation& simulate_;
  std::vector<std::size_t> rows_;
  double greatest_force_ = 0.0;
  std::map<std::array<double, 3>, std::optional<PressCurve>> known_;
};

}  // namespace softfinger
