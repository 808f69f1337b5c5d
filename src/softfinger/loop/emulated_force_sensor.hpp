#pragma once

#include <memory>

#include "softfinger/twin/twin.hpp"

namespace softfinger {

/// What an emulated force sensor is pressed with: a finger in the device, as a twin feels it.
/// press() does not allocate.
class EmulatedForceSensor {
 public:
  /// `wearer`: whose finger is in the device.
  EmulatedForceSensor(std::shared_ptr<const FingerModel> wearer,
                      std::shared_ptr<const Device> device);

  /// The normal force with the device at q, `elapsed` s after the last, N.
  double press(const Configuration& q, double friction_coefficient, double elapsed);
  /// The last, N.
  [[nodiscard]] double force() const { return twin_.contact().normal_force; }

 private:
  Twin twin_;
};

}  // namespace softfinger
