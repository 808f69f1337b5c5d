#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// Where the pins of a rectangular array stand: pin I, J (number I * columns + J) at
/// x = (I - (rows - 1) / 2) pitch, y = (J - (columns - 1) / 2) pitch of B', its end disk at its
/// height along z. m.
class PinField {
 public:
  PinField(int rows, int columns, double pitch, double radius, const Pose& X_FB)
      : rows_(rows), columns_(columns), pitch_(pitch), radius_(radius), X_BF_(X_FB.inverse()) {}

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int count() const { return rows_ * columns_; }
  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] double x(int pin) const {
    const int row = pin / columns_;
    return (row - 0.5 * (rows_ - 1)) * pitch_;
  }
  [[nodiscard]] double y(int pin) const { return (pin % columns_ - 0.5 * (columns_ - 1)) * pitch_; }
  /// A point of F in B'.
  [[nodiscard]] Vector3 in_mount(const Vector3& p_F) const { return X_BF_ * p_F; }
  /// Distance of (x, y) to a pin's flank, m; negative inside.
  [[nodiscard]] double beyond(int pin, double px, double py) const {
    const double dx = px - x(pin);
    const double dy = py - y(pin);
    return std::sqrt(dx * dx + dy * dy) - radius_;
  }

  /// Calls visit(pin, beyond) for pins around (x, y), nearer rings of the grid first, as long as a
  /// ring may hold a pin with beyond <= reach(); reach is asked again before every ring.
  template <typename Reach, typename Visit>
  void around(double px, double py, Reach&& reach, Visit&& visit) const {
    const int row = nearest(px, rows_);
    const int column = nearest(py, columns_);
    const int last = std::max({row, rows_ - 1 - row, column, columns_ - 1 - column});
    for (int ring = 0; ring <= last; ++ring) {
      // Seen from within half a pitch of the ring's centre, or from outside the grid.
      if (ring > 0 && (ring - 0.5) * pitch_ - radius_ > reach()) return;
      for (int i = std::max(row - ring, 0); i <= std::min(row + ring, rows_ - 1); ++i) {
        const int step = std::abs(i - row) == ring ? 1 : 2 * ring;
        for (int j = column - ring; j <= column + ring; j += step) {
          if (j < 0 || j >= columns_) continue;
          const int pin = i * columns_ + j;
          visit(pin, beyond(pin, px, py));
        }
      }
    }
  }

 private:
  [[nodiscard]] int nearest(double coordinate, int count) const {
    const double place = std::round(coordinate / pitch_ + 0.5 * (count - 1));
    return static_cast<int>(std::clamp(place, 0.0, static_cast<double>(count - 1)));
  }

  int rows_, columns_;
  double pitch_, radius_;
  Pose X_BF_;
};

/// Signed distance to one pin that goes down without end, by its end's height.
struct PinDistance {
  double distance = 0.0;   ///< m
  double by_height = 0.0;  ///< derivative
};
/// `above`: of the point over the pin's end, `beyond`: to its flank; m.
[[nodiscard]] inline PinDistance pin_distance(double beyond, double above) {
  if (beyond <= 0.0) return above > beyond ? PinDistance{above, -1.0} : PinDistance{beyond, 0.0};
  if (above <= 0.0) return {beyond, 0.0};
  const double distance = std::sqrt(beyond * beyond + above * above);
  return {distance, -above / distance};
}

}  // namespace softfinger
