#pragma once

#include <span>
#include <vector>

#include "softfinger/device/device.hpp"

namespace softfinger {

/// A device's solid and surface against resting skin. Both outlive it.
class RestingGap {
 public:
  /// `skin`: points of it in F, m.
  RestingGap(const Device& device, std::span<const Vector3> skin);

  /// The least, m, below 0 where it presses; skin moved by `shift` along `axis_F`.
  [[nodiscard]] double at(const Configuration& q, double shift = 0.0,
                          const Vector3& axis_F = Vector3::Zero());

 private:
  const Device& device_;
  std::vector<SolidPiece> pieces_;
  std::vector<double> x_, y_, z_;
};

}  // namespace softfinger
