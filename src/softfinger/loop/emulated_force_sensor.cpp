#include "softfinger/loop/emulated_force_sensor.hpp"

#include <utility>

namespace softfinger {

EmulatedForceSensor::EmulatedForceSensor(std::shared_ptr<const FingerModel> wearer,
                                         std::shared_ptr<const Device> device, double noise,
                                         std::uint64_t seed)
    : twin_(std::move(wearer), std::move(device)), noise_(noise), random_(seed) {}

const ForceReading& EmulatedForceSensor::measure(const Configuration& q,
                                                 double friction_coefficient, double elapsed) {
  twin_.press(q, friction_coefficient, elapsed);
  reading_.configuration = q;
  reading_.normal_force = twin_.contact().normal_force + noise_ * normal_(random_) + 0.0;
  return reading_;
}

}  // namespace softfinger
