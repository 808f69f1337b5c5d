#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/device/device.hpp"
#include "softfinger/device/surfaces/pointwise_surface.hpp"
#include "softfinger/motors/motor_kinds.hpp"

namespace softfinger {

struct LeverShape {
  std::string port = "emulator";
  double rate = 30.0;
  bool wedge = false;  ///< pitch in (5, 10) degrees is forbidden where roll > -5 degrees
  bool reversed_servo = false;
  double acceleration = std::numeric_limits<double>::infinity();  ///< rad/s^2
  std::string kind = "maestro";                                   ///< of transport
  int max_temperature = 70;  ///< of its servos, degrees Celsius
  double press_time = 0.0;   ///< s
  bool limp_at_end = false;
  bool crc = false;             ///< of a Maestro's commands
  double serial_timeout = 0.0;  ///< of a Maestro, s
};

/// Kinematics simple enough to check commands by hand: three levers whose angles are linear in
/// q = (pitch, roll, travel), with joint limits, a tilt limit, and optionally a forbidden wedge
/// that makes the workspace non-convex.
class LeverPlatform : public Kinematics {
 public:
  using Shape = LeverShape;
  static constexpr double kMaxTilt = 30.0 * deg;
  static constexpr double kGain = 40.0;    ///< rad/m
  static constexpr double kLever = 12e-3;  ///< m

  LeverPlatform(const DeviceSettings& settings, bool wedge) : Kinematics(settings), wedge_(wedge) {}

  bool inverse_kinematics(const Configuration& q, JointAngles& joints) const override {
    if (q.size() != 3 || !q.allFinite()) return false;
    joints.resize(3);
    for (int i = 0; i < 3; ++i) {
      const double azimuth = 2.0 * std::numbers::pi / 3.0 * i;
      joints[i] = kGain * (q[2] + kLever * (std::cos(azimuth) * q[0] + std::sin(azimuth) * q[1])) +
                  30.0 * deg;
    }
    return true;
  }
  bool forward_kinematics(const JointAngles& joints, Configuration& q) const override {
    q.setZero(3);
    for (int i = 0; i < 3; ++i) {
      const double azimuth = 2.0 * std::numbers::pi / 3.0 * i;
      const double height = (joints[i] - 30.0 * deg) / kGain;
      q[0] += 2.0 / 3.0 * std::cos(azimuth) * height / kLever;
      q[1] += 2.0 / 3.0 * std::sin(azimuth) * height / kLever;
      q[2] += height / 3.0;
    }
    return reachable(q);
  }
  bool reachable(const Configuration& q) const override {
    JointAngles joints;
    if (!inverse_kinematics(q, joints)) return false;
    if (wedge_ && q[0] > 5.0 * deg + 1e-9 && q[0] < 10.0 * deg - 1e-9 && q[1] > -5.0 * deg + 1e-9) {
      return false;
    }
    return ((joints - joint_limits().min).array() >= -1e-9).all() &&
           ((joint_limits().max - joints).array() >= -1e-9).all() &&
           std::hypot(q[0], q[1]) <= kMaxTilt + 1e-9;
  }

  int approach_axis() const override { return 2; }
  Pose pose(const Configuration&) const override { return {}; }
  RigidMotion motion(const Configuration&) const override { return {}; }

 private:
  [[nodiscard]] std::unique_ptr<Kinematics> copy() const override {
    return std::make_unique<LeverPlatform>(*this);
  }

  bool wedge_;
};

/// The level plane at the levers' travel.
class LevelPlane : public PointwiseSurface<LevelPlane> {
 public:
  struct Placed {
    double height;
    ClosestPointResidual closest_point_residual(const Vector3&) const { return {}; }
    SurfaceDistance signed_distance(const Vector3& p) const {
      return {p.z() - height, -Configuration::Unit(3, 2)};
    }
  };
  Placed placed(const Kinematics&, const Configuration& q) const { return {q[2]}; }
  void solid_pieces(const Kinematics&, const Configuration&, std::span<SolidPiece>) const override {
  }
};

inline ServoSettings maestro_servo(const LeverShape& shape, int i) {
  const double sign = shape.reversed_servo && i == 1 ? -1.0 : 1.0;
  return {.channel = 2 * i,
          .zero = sign > 0.0 ? 1500.3e-6 : 1900e-6,
          .per_radian = sign * 10e-6 / deg,
          .min = 700e-6,
          .max = 2500e-6};
}

/// Ids 1, 3, 5; the middle one may be reversed.
inline ServoSettings bus_servo(const LeverShape& shape, int i) {
  const double sign = shape.reversed_servo && i == 1 ? -1.0 : 1.0;
  return {.channel = 2 * i + 1,
          .zero = 2048.0,
          .per_radian = sign * 4096.0 / (360.0 * deg),
          .min = 900.0,
          .max = 3200.0,
          .step = 1.0};
}

inline ServoSettings lever_servo(const LeverShape& shape, int i) {
  if (shape.kind == "maestro") return maestro_servo(shape, i);
  if (shape.kind == "osc") {
    return {.zero = 0.0,
            .per_radian = 1.0 / deg,
            .min = -25.0,
            .max = 95.0,
            .step = 1e-6,
            .address = "/lever/" + std::to_string(i)};
  }
  if (shape.kind == "weart") {
    return {.zero = 0.0,
            .per_radian = 0.1 / mm,
            .min = 0.0,
            .max = 0.9,
            .step = 1e-6,
            .address = "RIGHT:INDEX"};
  }
  return bus_servo(shape, i);
}

inline DeviceSettings lever_settings(const LeverShape& shape) {
  DeviceSettings settings;
  settings.kind = "lever_platform";
  settings.axes = {ConfigurationAxis::angle("pitch_deg", LeverPlatform::kLever),
                   ConfigurationAxis::angle("roll_deg", LeverPlatform::kLever),
                   ConfigurationAxis::length("travel_mm")};
  settings.home = Configuration::Zero(3);
  settings.retracted = Configuration::Zero(3);
  settings.retracted[2] = -8.0 * mm;
  settings.joint_limits = {JointAngles::Constant(3, -20.0 * deg),
                           JointAngles::Constant(3, 90.0 * deg), 400.0 * deg, shape.acceleration};
  settings.following_error = 10.0 * deg;
  settings.press_time = shape.press_time;
  TransportSettings transport;
  transport.limp_at_end = shape.limp_at_end;
  transport.kind = shape.kind;
  transport.port = shape.port;
  transport.rate = shape.rate;
  const MotorKind& kind = motor_kind(shape.kind);
  transport.unit = kind.unit;
  transport.unit_scale = kind.unit_scale;
  transport.follows_travel = kind.follows_travel;
  if (kind.whole_set_points) transport.baud = 1000000;
  transport.max_temperature = shape.max_temperature;
  transport.crc = shape.crc;
  transport.serial_timeout = shape.serial_timeout;
  for (int i = 0; i < (transport.follows_travel ? 1 : 3); ++i) {
    transport.servos.push_back(lever_servo(shape, i));
  }
  settings.transport = transport;
  return settings;
}

inline std::shared_ptr<const Device> lever_platform(const LeverShape& shape = {}) {
  DeviceSettings settings = lever_settings(shape);
  auto kinematics = std::make_unique<const LeverPlatform>(settings, shape.wedge);
  return std::make_shared<const Device>(std::move(settings), std::move(kinematics),
                                        std::make_unique<const LevelPlane>());
}

}  // namespace softfinger
