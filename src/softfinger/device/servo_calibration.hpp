#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "softfinger/device/device.hpp"
#include "softfinger/motors/emulation/emulated_bus.hpp"
#include "softfinger/motors/servo_bus.hpp"
#include "softfinger/motors/servo_map.hpp"

namespace softfinger {

/// What a person sees of one servo while it is calibrated; rad, or m where joints are lengths.
struct ServoSighting {
  double told = 0.0;   ///< how far the joint should have moved by the map so far, not 0
  double at = 0.0;     ///< where the joint really stood before
  double moved = 0.0;  ///< how far it really moved, with its sign
};

/// The map of a servo that stood at `setpoint` when it was looked at; its least and largest set
/// point stay. Throws InputError for a joint that did not move, or moved not half or more than
/// twice as far as it was told, and for one that stood nowhere.
[[nodiscard]] ServoSettings calibrated(const ServoSettings& servo, double setpoint,
                                       const ServoSighting& seen);

/// Joint range that a servo's least and largest set point allow.
struct JointRange {
  double min = 0.0, max = 0.0;
};
[[nodiscard]] JointRange joint_range(const ServoSettings& servo);

/// Moves the servos of a device one by one, slowly, from the home of the map so far. Set points
/// stay within the file's, joints within their limits. However it ends, the device is led to where
/// it is retracted, by that map.
class ServoCalibration {
 public:
  /// Opens the port (empty: the file's) and goes home. Throws InputError where it cannot be opened,
  /// or where servos follow no joints. `stop` outlives this: what moves throws OperationError soon
  /// after it has become true.
  ServoCalibration(std::shared_ptr<const Device> device, const std::string& port,
                   const std::atomic<bool>& stop);
  ~ServoCalibration();
  ServoCalibration(const ServoCalibration&) = delete;
  ServoCalibration& operator=(const ServoCalibration&) = delete;

  [[nodiscard]] int servos() const { return static_cast<int>(maps_.size()); }
  /// Joint angle of a servo at home, by the map so far.
  [[nodiscard]] double home(int servo) const { return home_[servo]; }
  /// Moves one joint away from home, as far as allowed and at most kStep (rad or a tenth of a mm a
  /// degree); returns how far by the map so far.
  double move_away(int servo);
  /// And back home.
  void move_back();
  [[nodiscard]] ServoSettings calibrated_servo(int servo, const ServoSighting& seen) const;

 private:
  /// Moves all joints to these angles by the map so far.
  void go(const JointAngles& joints);
  /// One command nearer to them, at this part of their largest speed; true: there. Throws
  /// OperationError where the port is gone.
  bool step(const JointAngles& joints, double speed);
  void retract() noexcept;

  std::shared_ptr<const Device> device_;
  std::vector<ServoMap> maps_;
  std::unique_ptr<EmulatedBus> emulated_;
  std::unique_ptr<ServoBus> bus_;
  const std::atomic<bool>& stop_;
  JointAngles home_;
  JointAngles now_;
};

}  // namespace softfinger
