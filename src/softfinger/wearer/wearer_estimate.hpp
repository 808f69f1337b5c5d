#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "softfinger/wearer/press_model.hpp"
#include "softfinger/wearer/press_reading.hpp"

namespace softfinger {

struct WearerEstimateOptions {
  double noise = 0.0;       ///< of one reading, standard deviation, N
  bool mount_only = false;  ///< of a finger that is known and put on again
  /// Where the search begins and what it is drawn to: the wearer as far as known.
  TraitVector known = TraitVector::Zero();
  /// Called after each step; false gives up.
  std::function<bool(double fraction)> progress;
};

/// What presses tell of a wearer.
struct WearerEstimate {
  TraitVector x = TraitVector::Zero();          ///< coordinates of WearerTraits
  TraitVector deviation = TraitVector::Zero();  ///< standard deviations of these; 0: not looked for
  /// Of these deviations, over those that people vary by, what is no better known than before.
  static constexpr double kUntold = 0.9;
  /// How far the force of a press is from what the others say of it, a fraction of that force:
  /// median over the presses; but not less than how far all together leave them off, the mean.
  double predicted_force_error = 0.0;
  /// How far the wearer as known before leaves the forces of a press off, a fraction of these:
  /// median over the presses.
  double known_force_error = 0.0;
  /// Of touches from the fit, root mean square, m.
  double touch_deviation = 0.0;
  double force_deviation = 0.0;  ///< of readings from the fit, root mean square, N
  int evaluations = 0;           ///< of all presses

  [[nodiscard]] bool is_told(WearerTrait trait) const {
    const double d = deviation[static_cast<Eigen::Index>(trait)];
    return d > 0.0 && d < kUntold;
  }
};

/// The traits that make `model` feel what was measured, in two stages, each by Gauss-Newton steps
/// with damping (Levenberg and Marquardt) against a prior: first the advance at which each press
/// reaches 0.1 N, in m, since skin that the model does not touch has no gradient of force; then the
/// forces. Leaves `model` with the traits found. Throws OperationError where presses tell nothing
/// or `progress` gives up.
[[nodiscard]] WearerEstimate estimate_wearer(PressModel& model,
                                             std::span<const PressRecord> presses,
                                             const WearerEstimateOptions& options);

/// The same from touches alone, as the first of these stages. Errors of force are those to be
/// expected of the force of a light press, one standard deviation by what is known of the traits:
/// how stiff the skin is no touch tells.
[[nodiscard]] WearerEstimate estimate_wearer(PressModel& model,
                                             std::span<const TouchRecord> touches,
                                             const WearerEstimateOptions& options);

}  // namespace softfinger
