#include "softfinger/device/device.hpp"

namespace softfinger {

double Device::squared_distance(const Configuration& a, const Configuration& b) const {
  double sum = 0.0;
  for (int k = 0; k < degrees_of_freedom(); ++k) {
    const double d = settings_.axes[static_cast<std::size_t>(k)].metric * (a[k] - b[k]);
    sum += d * d;
  }
  return sum;
}

}  // namespace softfinger
