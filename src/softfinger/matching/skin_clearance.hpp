#pragma once

#include <vector>

#include "softfinger/contact/contact_set.hpp"
#include "softfinger/device/device.hpp"

namespace softfinger {

/// The skin of one tick against a device's surface, for poses that do not touch it. Allocates only
/// in the constructor.
class SkinClearance {
 public:
  SkinClearance(const Device& device, int capacity);

  void take(const ContactSet& contact);
  /// Least signed distance of the samples to the surface at q, m.
  [[nodiscard]] double gap(const Configuration& q) const;
  /// q advanced so that gap(q) is `wanted` (m); q itself where the device does not advance or there
  /// are no samples.
  [[nodiscard]] Configuration with_gap(const Configuration& q, double wanted) const;

 private:
  const Device& device_;
  std::vector<double> x_, y_, z_;
  SurfaceSamples samples_;
};

}  // namespace softfinger
