#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/device/configuration.hpp"
#include "softfinger/device/device_objectives.hpp"
#include "softfinger/device/motor_statics.hpp"
#include "softfinger/geometry/pose.hpp"
#include "softfinger/motors/joint_limits.hpp"
#include "softfinger/motors/transport_settings.hpp"
#include "softfinger/sensing/force_sensor_settings.hpp"

namespace softfinger {

/// One component of a configuration q.
struct ConfigurationAxis {
  static constexpr double kNoLimit = std::numeric_limits<double>::infinity();

  std::string name;      ///< with the unit people read: "pitch_deg", "travel_mm"
  bool angular = false;  ///< rad inside and degrees for people; else m and mm
  double metric = 1.0;   ///< m per SI unit: how far the surface moves; the disk's radius for angles
  /// Limits of its own; SI. Infinite where only joints or other axes limit it.
  double min = -kNoLimit, max = kNoLimit;

  /// SI per unit of the name.
  [[nodiscard]] double unit() const { return angular ? deg : mm; }
  [[nodiscard]] static ConfigurationAxis angle(std::string name, double metric,
                                               double min = -kNoLimit, double max = kNoLimit) {
    return {std::move(name), true, metric, min, max};
  }
  [[nodiscard]] static ConfigurationAxis length(std::string name, double min = -kNoLimit,
                                                double max = kNoLimit) {
    return {std::move(name), false, 1.0, min, max};
  }
};

/// How fast a rendering gives back what means nothing to the wearer, beside the object's own motion
/// and whatever the motors do, SI: the same on any mesh and at any rate of the device's ticks.
struct EasingRates {
  double turn_on_skin = 36.0 * deg;
  double turn_off_skin = 75.0 * deg;
  double move_off_skin = 30.0 * mm;
  double turn_by_force = 90.0 * deg;  ///< of what the twin's force adds to the surface's answer
  double move_by_force = 30.0 * mm;
};

/// `[matching]` of a device file.
struct MatchingSettings {
  double separation_tolerance = 2e-4;  ///< eps, m
  double approach = 3e-3;              ///< least gap below which the device follows the skin, m
  std::string objective{kDeviceObjectives.front()};
  EasingRates easing;
};

/// What every kind of device has beside its geometry.
struct DeviceSettings {
  std::string kind;
  std::vector<ConfigurationAxis> axes;
  bool names_axes = false;  ///< the file itself chose the names of its axes
  Pose X_FB;                ///< mount: neutral frame B' in F
  /// How far X_FB stands further out, against its z, than the file says, to fit a finger; m.
  double mount_shift = 0.0;
  /// How X_FB stands otherwise on this wearer, as found on them: moved by the translation, turned
  /// by the rotation about its own origin, both in F.
  Pose mount_fit;
  /// Least gap to the resting skin of whoever wears it that the mount is shifted to, where the
  /// configuration is zero (at home where that is out of reach), m.
  std::optional<double> clearance;
  Configuration home;       ///< where the device rests when nothing is near
  Configuration retracted;  ///< where it goes when a run stops or stalls
  JointLimits joint_limits;
  double max_force = 0.0;  ///< normal force on the finger that is never exceeded, N; 0: not given
  /// A servo that says it is further than this from where it was sent does not follow, rad or m;
  /// 0: not looked at.
  double following_error = 0.0;
  double press_time = 0.0;  ///< longest without a pause, s; 0: any
  MatchingSettings matching;
  std::optional<MotorStatics> statics;  ///< none: motors are where they are sent, whatever presses
  std::optional<TransportSettings> transport;
  std::optional<ForceSensorSettings> force_sensor;
  std::string as_read;  ///< the device file as JSON, defaults filled in
  std::string text;     ///< the device file

  /// From now on with this mount_fit, X_FB as it says.
  void fit_mount(const Pose& fit) {
    X_FB.rotation = fit.rotation * mount_fit.rotation.transpose() * X_FB.rotation;
    X_FB.translation += fit.translation - mount_fit.translation;
    mount_fit = fit;
  }
};

}  // namespace softfinger
