#pragma once

#include <optional>
#include <vector>

#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

/// What a press curve depends on besides shape: factor on Young's modulus of every layer, and
/// strain limits.
struct FingerConstants {
  double youngs_modulus_factor = 1.0;
  double min = 0.0, max = 0.0;  ///< stretch limits; without meaning where the finger has none
  friend bool operator==(const FingerConstants&, const FingerConstants&) = default;
};

/// The finger with these constants; stiffness and width of the limits stay.
[[nodiscard]] FingerModel with_constants(const FingerModel& model,
                                         const FingerConstants& constants);

/// Force and contact area of one press on a flat plate, as continuous functions.
class PressCurve {
 public:
  /// depths h, 2h, ... m, at least four; forces N; areas m^2.
  PressCurve(double spacing, std::vector<double> forces, const std::vector<double>& areas);

  /// N, 0 <= depth <= deepest(). Cubic Hermite interpolation of force^(2/3), which is straight for
  /// an elastic sphere (Hertz).
  [[nodiscard]] double force(double depth) const;
  [[nodiscard]] double deepest() const { return spacing_ * static_cast<double>(forces_.size()); }
  [[nodiscard]] double greatest_force() const { return forces_.back(); }
  /// m^2 at a force above 0. The area of a mesh grows sample by sample; this is the parabola in the
  /// logarithms of area and force through all of the press.
  [[nodiscard]] double area(double force) const;

 private:
  double spacing_;
  std::vector<double> forces_;
  std::vector<double> roots_;  ///< force^(2/3) from depth 0 on
  double area_log_[3] = {0.0, 0.0, 0.0};
};

/// Simulated quasi-static press of the finger on a plate to `depth` (m). Empty where a row does not
/// reach equilibrium. `pitch` turns the finger about its y axis, rad.
[[nodiscard]] std::optional<PressCurve> simulate_press(const FingerModel& model, double depth,
                                                       double pitch);

}  // namespace softfinger
