#pragma once

#include <cstdint>
#include <memory>
#include <random>

#include "softfinger/device/force_reading.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {

/// A force sensor in an emulated device: what a finger in it would be pressed with, as a twin
/// feels it, with noise. measure() does not allocate.
class EmulatedForceSensor {
 public:
  /// `wearer`: whose finger is in the device. `noise`: standard deviation, N, >= 0. `seed`: of the
  /// noise; the same seed, the same noise.
  EmulatedForceSensor(std::shared_ptr<const FingerModel> wearer,
                      std::shared_ptr<const Device> device, double noise, std::uint64_t seed);

  /// With the device at q, `elapsed` s after the last.
  const ForceReading& measure(const Configuration& q, double friction_coefficient, double elapsed);
  /// The same without noise, N.
  [[nodiscard]] double force() const { return twin_.contact().normal_force; }

 private:
  Twin twin_;
  double noise_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  ForceReading reading_;
};

}  // namespace softfinger
