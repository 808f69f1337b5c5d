#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/loop/measured_force.hpp"
#include "softfinger/person/person.hpp"
#include "softfinger/sensing/force_sensor_emulator.hpp"
#include "softfinger/session/run_observer.hpp"
#include "softfinger/session/stop_signals.hpp"
#include "softfinger/wearer/press_procedure.hpp"
#include "softfinger/wearer/wearer_estimate.hpp"

namespace softfinger {

/// What an emulated device and its wearer are like, beyond their files.
struct EmulatedWear {
  Pose
      mount;  ///< how it sits on the wearer otherwise than its file says, DeviceSettings::mount_fit
  std::optional<double> friction_coefficient;  ///< instead of the wearer's
  double gain = 1.0;                           ///< of the sensor
  double backlash = 0.0;                       ///< of the advance, from end to end, m
  int late = 0;                                ///< ticks, of the sensor, beyond the one it takes
  double reaction = 0.2;                       ///< from a touch to the wearer's word, mean, s
  double reaction_spread = 0.04;               ///< the same, standard deviation
};

/// What a device does that learns its wearer, after one of its ticks.
struct DeviceFitMoment {
  bool estimating = false;         ///< it has retracted; what is pressed for the estimate is a twin
  int press = 0;                   ///< under way, from 1; 0: the sensor's zero is looked for
  int presses = 0;                 ///< of so many
  double pitch = 0.0, roll = 0.0;  ///< of the press, rad
  double force = 0.0;              ///< N, as the sensor says; 0 without one
  double progress = 0.0;           ///< 0 to 1, of the presses, or of the estimate
};

/// Which device learns which wearer.
struct DeviceFitOptions {
  std::filesystem::path device, finger;
  std::filesystem::path person;  ///< to write; kept, but for this finger
  std::string name = "index";    ///< of the finger in it
  /// Finger file of whom an emulated device is on; empty: `finger`.
  std::optional<std::filesystem::path> wearer;
  /// An emulated force sensor for a device file that has none.
  std::optional<ForceSensorKind> sensor;
  std::optional<double> sensor_noise;  ///< of an emulated sensor instead of the device file's, N
  std::uint64_t seed = 1;              ///< of that noise
  EmulatedWear wear;
  bool again = false;  ///< the person's finger is known, the device was put on again: mount alone
  /// Without a force sensor, from touches that the wearer tells.
  bool by_touch = false;
  /// Asked at each tick of a device with motors: whether the wearer has told a touch since the
  /// last. Where motors are emulated the wearer is, and tells by itself.
  std::function<bool()> told;
  /// Everything by the clock on the wall, through port, guard process and wires, although all is
  /// emulated.
  bool real_time = false;
  std::filesystem::path guard_program;
  const StopSignals* stop_signals = nullptr;  ///< each stops the device, which ends it; null: none
  /// What is wrong with an emulated sensor, from so many seconds on.
  ForceSensorFault fault = ForceSensorFault::kNone;
  double fault_at = 0.0;                              ///< s
  std::function<void(const DeviceFitMoment&)> watch;  ///< called in between; empty: nobody looks
};

/// What a device has learned of its wearer.
struct DeviceFit {
  bool by_touch = false;
  int presses = 0;              ///< or touches
  double duration = 0.0;        ///< of all presses, s of the device
  double greatest_force = 0.0;  ///< measured, or of the emulated finger where that is more, N
  double delay = 0.0;           ///< of the sensor, s
  double noise = 0.0;           ///< of the sensor, N
  double apart = 0.0;           ///< the first touch and the last, which is the same, m
  WearerEstimate estimate;
  /// One trait, SI; a size in m, a modulus as a factor.
  struct Told {
    WearerTrait trait;
    double value, ci95_low, ci95_high, prior;
  };
  std::vector<Told> traits;
  /// Where the tracked body sits by the finger found, of one that was registered on a table;
  /// empty: it was not, or see `registration_failure`.
  std::optional<Registration> registration;
  double registration_moved = 0.0;   ///< from where it was thought to sit, m
  std::string registration_failure;  ///< why it stays as it was, in one line
  std::filesystem::path written;     ///< empty: nothing was, see `failure`
  std::string failure;               ///< in one line; empty: it succeeded
};

/// What became of a registration, in one line; empty: there is none.
[[nodiscard]] std::string told_of_registration(const DeviceFit& fit);

/// How wrong the force of a press may be that the others foretell: with more nothing is written.
inline constexpr double kMostForetoldError = 0.2;
/// How far touches may be from those of the finger found, root mean square, m; with more nothing is
/// written.
inline constexpr double kMostTouchDeviation = 0.4e-3;
/// How far apart the wearer may tell the first touch and the last, which is the same, m.
inline constexpr double kMostApart = 0.3e-3;

/// Presses the wearer by itself, from tilt to tilt, through the same guards as a run, retracts, and
/// writes what that tells of the finger into the person's file: sizes, modulus factor, mount. By
/// touches it presses nothing, and how stiff the skin is stays as it was thought to be. All
/// of a device that is emulated goes in simulated time, as fast as it can. A stop, the end that
/// `stop` asks for and every failure retract the device first. Throws InputError for files,
/// OperationError where the person's file cannot be written.
[[nodiscard]] DeviceFit fit_device(const DeviceFitOptions& options, const std::atomic<bool>& stop,
                                   const RunObserver& observer = {});

}  // namespace softfinger
