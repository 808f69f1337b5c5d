#include "softfinger/loop/emulated_force_sensor.hpp"

#include <utility>

namespace softfinger {

EmulatedForceSensor::EmulatedForceSensor(std::shared_ptr<const FingerModel> wearer,
                                         std::shared_ptr<const Device> device)
    : twin_(std::move(wearer), std::move(device)) {}

double EmulatedForceSensor::press(const Configuration& q, double friction_coefficient,
                                  double elapsed) {
  twin_.press(q, friction_coefficient, elapsed);
  return force();
}

}  // namespace softfinger
