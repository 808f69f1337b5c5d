#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "softfinger/device/device.hpp"

namespace softfinger {

/// Holds what comes back from a device against what it was told: servos that do not follow their
/// commands (a following error, as ISO 10218 and CiA 402 have it), and a finger that is pressed
/// without a pause. Pure: no I/O, and time is what the caller says. Allocates nothing.
class Supervision {
 public:
  /// A servo has so long, s, to get to where it was sent, at least.
  static constexpr double kFollowTime = 0.5;
  /// A finger that was let go for so long, s, has had its pause.
  static constexpr double kPause = 0.5;
  /// So many reports in a row, before a servo is said not to follow.
  static constexpr int kReports = 3;

  /// Limits: DeviceSettings::following_error and press_time of the device.
  explicit Supervision(const Device& device);

  /// From here on, as after an opened port: nothing is known of what came before.
  void restart();
  /// Joints that a command wants; `time` in s, never decreasing.
  void sent(double time, const JointAngles& joints);
  /// Where the servos said they are: bit i of those that do not follow.
  std::uint32_t seen(double time, const JointAngles& joints);
  /// Whether the finger has been pressed for too long; `pressing`: now.
  [[nodiscard]] bool pressed_too_long(double time, bool pressing);

 private:
  /// Least and largest commands of one stretch of time; of no joints: there were none.
  struct Stretch {
    double begin = 0.0;  ///< s
    JointAngles least, largest;
  };
  static constexpr std::size_t kStretches = 5;

  double most_error_;
  double most_pressing_;
  std::array<Stretch, kStretches> stretches_;
  std::size_t newest_ = 0;
  std::array<int, kMostServos> astray_reports_{};
  std::optional<double> pressed_since_;
  double last_pressed_ = 0.0;
};

}  // namespace softfinger
