#pragma once

#include <span>
#include <vector>

#include "softfinger/contact/object_dynamics.hpp"

namespace softfinger {

/// The force of a button by its travel (m, N) as a monotone cubic between points: no higher than
/// the points beside it, no lower, and smooth (Fritsch and Carlson, "Monotone piecewise cubic
/// interpolation", SIAM J. Numer. Anal. 17(2), 1980; slopes as Fritsch and Butland, "A method for
/// constructing local monotone piecewise cubic interpolants", SIAM J. Sci. Stat. Comput. 5(2),
/// 1984: what PCHIP computes). Beyond its points it goes on with its end slopes.
class ForceCurve {
 public:
  /// Two points or more, travel increasing.
  explicit ForceCurve(const JointCurve& points);

  struct Value {
    double work = 0.0;   ///< from travel 0 to there, J
    double force = 0.0;  ///< N
    double slope = 0.0;  ///< N/m
  };
  [[nodiscard]] Value at(double travel) const;
  /// The least slope of travels between these two, N/m.
  [[nodiscard]] double least_slope(double from, double to) const;

  /// Where the force falls although it is pressed further: from `top` to `valley`, travel in m. The
  /// valley is infinite where it never rises again.
  struct Snap {
    double top = 0.0;
    double valley = 0.0;
  };
  /// In order of travel.
  [[nodiscard]] std::span<const Snap> snaps() const { return snaps_; }

 private:
  /// A cubic of the way from `start`; the first is before all points, the last behind them.
  struct Piece {
    double start = 0.0;
    double work = 0.0, force = 0.0, slope = 0.0;  ///< at the start
    double second = 0.0, third = 0.0;             ///< coefficients, N/m^2 and N/m^3
    [[nodiscard]] Value at(double travel) const;
  };

  std::vector<double> travel_;
  std::vector<Piece> pieces_;
  std::vector<Snap> snaps_;
};

}  // namespace softfinger
