#include "softfinger/loop/measured_force.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "softfinger/sensing/force_sensor_emulator.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {

MeasuredForce::MeasuredForce(std::shared_ptr<const FingerModel> wearer,
                             std::shared_ptr<const Device> device, const Options& options)
    : settings_(options.settings ? *options.settings : device->settings().force_sensor.value()),
      says_(settings_.noise, options.seed, settings_.hysteresis) {
  const bool wire = options.live && settings_.kind != ForceSensorKind::kEmulator;
  if (wire) sensor_ = std::make_unique<ForceSensor>(settings_);
  if (!wire || settings_.is_emulated()) {
    emulated_ = std::make_unique<EmulatedForceSensor>(std::move(wearer), std::move(device));
  }
}

const ForceReading& MeasuredForce::measure(const Configuration& q, double friction_coefficient,
                                           double elapsed) {
  reading_.configuration = q;
  if (emulated_) {
    const double force = emulated_->press(q, friction_coefficient, elapsed);
    if (!sensor_) {
      const auto says = says_.reading(force);
      // One that stands for a real sensor is calibrated as well.
      reading_.normal_force =
          (settings_.is_emulated() ? settings_.scale : 1.0) * says.value_or(0.0);
      if (!says) reading_.configuration.resize(0);
      new_readings_ = says ? 1 : 0;
      return reading_;
    }
    sensor_->emulator()->press(force);
  }
  const ForceSample& sample = sensor_->look();
  const std::uint64_t fresh = sample.count - count_;
  new_readings_ = static_cast<int>(std::min<std::uint64_t>(fresh, 1000000));
  reading_.normal_force =
      fresh == 0 ? sample.force : (sample.sum - sum_) / static_cast<double>(fresh);
  count_ = sample.count;
  sum_ = sample.sum;
  if (!sensor_->is_fresh(sample, monotonic_time())) reading_.configuration.resize(0);
  return reading_;
}

double MeasuredForce::true_force() const {
  return emulated_ ? emulated_->force() : std::numeric_limits<double>::quiet_NaN();
}

void MeasuredForce::fail(ForceSensorFault fault) {
  says_.fail(fault);
  if (sensor_ && sensor_->emulator() != nullptr) sensor_->emulator()->fail(fault);
}

}  // namespace softfinger
