#pragma once

#include <cstdint>

namespace softfinger {

class Device;

/// The device's ticks per second; 30 for a device file without a transport. Hz.
[[nodiscard]] double device_rate(const Device& device);

/// Device ticks on simulated time: tick k falls in the first step that ends at or after
/// k / device_rate. Step n ends at n / simulation_rate; steps count from 1, so tick 0 falls in
/// step 1. Ticks that fall in the same step are one.
class DeviceClock {
 public:
  /// Rates in Hz.
  DeviceClock(double simulation_rate, double device_rate)
      : simulation_rate_(simulation_rate), device_rate_(device_rate) {}

  /// Whether a tick falls in `step`. Call for every step in turn.
  bool ticks(std::int64_t step) {
    // Products of whole rates and counts are exact, quotients are not.
    const double elapsed = static_cast<double>(step) * device_rate_;
    if (elapsed < static_cast<double>(next_) * simulation_rate_) return false;
    do {
      ++next_;
    } while (elapsed >= static_cast<double>(next_) * simulation_rate_);
    return true;
  }

 private:
  double simulation_rate_;
  double device_rate_;
  std::int64_t next_ = 0;
};

}  // namespace softfinger
