#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/identification/indentation_data.hpp"
#include "softfinger/identification/press_curve.hpp"

namespace softfinger {

enum class FitParameter { kYoungsModulus, kMin, kMax };
/// As the finger file's key: youngs_modulus_kPa, min, max.
[[nodiscard]] std::string name_of(FitParameter parameter);

/// How far a measured force may be off: in proportion to itself, or alike everywhere.
enum class ForceNoise { kRelative, kAbsolute };

/// Press curve with these constants, to the depth of the data; empty where it cannot be computed.
using PressSimulation = std::function<std::optional<PressCurve>(const FingerConstants&)>;

struct FitInput {
  MeasuredColumns curve;                 ///< depth m, force N
  std::optional<MeasuredColumns> areas;  ///< force N, area m^2
  FingerConstants start;                 ///< those of the finger file
  double width = 0.0;                    ///< of the limits' onset in the finger file
  bool has_limits = false;
  /// These and no others; empty: all that the data can tell. Those asked for that they cannot tell
  /// are refused.
  std::vector<FitParameter> parameters;
  std::optional<ForceNoise> noise;  ///< empty: the likelier one
};

struct FingerFit {
  FingerConstants constants;
  struct Estimate {
    FitParameter parameter = FitParameter::kYoungsModulus;
    double value = 0.0;  ///< a factor for Young's modulus
    double ci95_low = 0.0, ci95_high = 0.0;
  };
  std::vector<Estimate> estimates;
  struct Kept {
    FitParameter parameter = FitParameter::kMin;
    std::string reason;
  };
  std::vector<Kept> kept;  ///< as they are in the file
  ForceNoise noise = ForceNoise::kRelative;
  double force_noise = 0.0;      ///< standard deviation: a fraction of the force, or N
  double area_noise = 0.0;       ///< standard deviation, a fraction of the area; 0 without areas
  double force_deviation = 0.0;  ///< root mean square of (simulated - measured) / measured
  int degrees_of_freedom = 0;
  int simulations = 0;
};

/// Estimates constants by weighted least squares of force over depth, and of area over force where
/// measured. Noise levels are estimated from the residuals; whether that of the forces is relative
/// or absolute is decided by likelihood. The 95 % intervals start from the linearised ones
/// (Student's t) and follow the sum of squares where it is not quadratic (see profile_interval);
/// they hold with the constants that are kept. A strain limit is estimated where forgetting it
/// would change a force by 2 % and its interval is narrower than the strain it allows; else it is
/// kept and the reason said. Throws InputError for a parameter asked for that the data cannot tell
/// and for a curve that no constants reach within 20 %, root mean square.
[[nodiscard]] FingerFit fit_finger(const FitInput& input, const PressSimulation& simulate);

/// Depth below which bone lies under the skin at the lowest point of the pad, m: no curve is
/// deeper.
[[nodiscard]] double pulp_depth(const FingerModel& model);

}  // namespace softfinger
