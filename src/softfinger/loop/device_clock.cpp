#include "softfinger/loop/device_clock.hpp"

#include "softfinger/device/device.hpp"

namespace softfinger {

double device_rate(const Device& device) {
  const auto& transport = device.settings().transport;
  return transport ? transport->rate : TransportSettings{}.rate;
}

}  // namespace softfinger
