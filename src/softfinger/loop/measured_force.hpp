#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "softfinger/device/force_reading.hpp"
#include "softfinger/loop/emulated_force_sensor.hpp"
#include "softfinger/sensing/force_sensor.hpp"
#include "softfinger/sensing/force_sensor_emulator.hpp"

namespace softfinger {

/// What a device's `[force_sensor]` says, tick by tick, whatever stands behind it: a sensor on its
/// wire, an emulated one at the far end of a wire, or, where no clock paces the run, an emulated
/// one without a wire. An emulated one feels what the wearer would in the device.
class MeasuredForce {
 public:
  struct Options {
    std::uint64_t seed = 0;  ///< of an emulated sensor's noise
    bool live = false;       ///< by the clock on the wall: what has a wire is read from it
    std::optional<ForceSensorSettings> settings = {};  ///< instead of the device file's
  };
  /// `device` as it sits on `wearer`; it has a force sensor, or the options have one. Throws
  /// InputError where the sensor's port cannot be opened.
  MeasuredForce(std::shared_ptr<const FingerModel> wearer, std::shared_ptr<const Device> device,
                const Options& options);

  /// With the device at q, `elapsed` s after the last: on a wire the mean of what came since. No
  /// configuration: nothing fresh. Allocates nothing.
  const ForceReading& measure(const Configuration& q, double friction_coefficient, double elapsed);
  /// How many readings the last one is the mean of.
  [[nodiscard]] int new_readings() const { return new_readings_; }
  /// What an emulated wearer is pressed with, N; NaN for a real one.
  [[nodiscard]] double true_force() const;
  /// Of what has a wire; null: it has none.
  [[nodiscard]] ForceSensor* on_wire() { return sensor_.get(); }
  /// What is wrong with an emulated sensor.
  void fail(ForceSensorFault fault);

 private:
  ForceSensorSettings settings_;
  std::unique_ptr<ForceSensor> sensor_;            ///< null: no wire
  std::unique_ptr<EmulatedForceSensor> emulated_;  ///< null: a real sensor
  FaultyForce says_;                               ///< without a wire
  std::uint64_t count_ = 0;
  double sum_ = 0.0;
  int new_readings_ = 0;
  ForceReading reading_;
};

}  // namespace softfinger
