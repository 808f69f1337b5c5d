#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <random>
#include <string>

#include "softfinger/actuation/actuator.hpp"
#include "softfinger/session/device_fit.hpp"
#include "softfinger/session/worn_device.hpp"
#include "softfinger/wearer/press_procedure.hpp"
#include "softfinger/wearer/touch_procedure.hpp"

namespace softfinger {

/// Whether the device's file names a port that is no emulator.
[[nodiscard]] bool has_motors(const Device& device);

/// A device on its wearer, with its motors and its force sensor, as a fit has it press or touch: at
/// the device's own rate by the clock where anything of it is real, else as fast as it goes.
class PressingDevice {
 public:
  /// `options` and `worn` outlive it. `wearer`: whom an emulated sensor presses. `sensor`: none
  /// where a wearer tells touches. `stops_seen`: of the stop signals of `options`, those before.
  PressingDevice(const DeviceFitOptions& options, const WornDevice& worn,
                 std::shared_ptr<const FingerModel> wearer,
                 const std::optional<ForceSensorSettings>& sensor, std::uint32_t stops_seen);

  /// Presses, or touches, until that is done or fails, so many in all; the device is retracted
  /// then.
  void run(PressProcedure& procedure, int presses, const std::atomic<bool>& stop,
           const RunObserver& observer);
  void run(TouchProcedure& procedure, int presses, const std::atomic<bool>& stop,
           const RunObserver& observer);

  /// Of its ticks, Hz.
  [[nodiscard]] double rate() const { return rate_; }
  /// As an emulated wearer felt it, N; 0: it is not known.
  [[nodiscard]] double greatest_true_force() const { return greatest_true_; }
  /// Why it ended before the procedure did; empty: it did not.
  [[nodiscard]] const std::string& interruption() const { return interruption_; }

 private:
  template <typename Procedure>
  void press(Procedure& procedure, int presses, const std::atomic<bool>& stop,
             const RunObserver& observer);
  void feel(PressProcedure& procedure, double time);
  void feel(TouchProcedure& procedure, double time);
  /// False where the sensor has nothing new.
  bool measure();
  /// Some time after a touch, and again while it lasts.
  bool emulated_wearer_tells(double time);
  template <typename Procedure>
  void tell(const Procedure& procedure, int presses) const;
  [[nodiscard]] bool is_live(const std::optional<ForceSensorSettings>& sensor) const;
  [[nodiscard]] ActuatorOptions actuator_options() const;
  /// True: it has to end.
  bool interrupted(const std::atomic<bool>& stop, const RunObserver& observer);
  /// Where the device is: as its servos say, else where it was sent.
  void look(const FormedCommand& command);

  const DeviceFitOptions& options_;
  const WornDevice& worn_;
  std::uint32_t stops_seen_;
  double friction_;
  double rate_;
  bool live_;
  std::optional<MeasuredForce> sensor_;
  Actuator actuator_;
  Configuration stands_;
  Configuration really_;                ///< an emulated one, with its play
  double followed_ = 0.0;               ///< advance of that, m
  std::deque<double> late_;             ///< forces on their way, N
  double measured_ = 0.0, said_ = 0.0;  ///< N
  bool touching_ = false;
  std::mt19937_64 random_;
  std::optional<double> tells_at_;  ///< s, of an emulated wearer who feels the device
  double greatest_true_ = 0.0;
  std::string interruption_;
};

}  // namespace softfinger
