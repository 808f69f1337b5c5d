#include "softfinger/device/servo_calibration.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

/// Of joints while they are calibrated: a fraction of their largest speed.
constexpr double kSlow = 0.05;
constexpr double kAway = 0.25;  ///< the same, where they retract
constexpr double kStepDegrees = 10.0;
constexpr double kStepMillimetres = 1.0;
/// The least step that can be told by eye, as a fraction of the whole.
constexpr double kLeastStep = 0.2;
constexpr double kCommandsPerSecond = 50.0;
constexpr int kRepeats = 15;  ///< of the retracted pose

}  // namespace

ServoSettings calibrated(const ServoSettings& servo, double setpoint, const ServoSighting& seen) {
  const double ratio = std::abs(seen.moved / seen.told);
  if (!(ratio >= 0.5 && ratio <= 2.0)) {
    throw InputError(
        "the joint did not move, or not half or more than twice as far as it was told; look at the "
        "servo's number and at its horn");
  }
  if (!std::isfinite(seen.at)) throw InputError("where the joint stands at home is no number");
  ServoSettings result = servo;
  result.per_radian = servo.per_radian * seen.told / seen.moved;
  result.zero = setpoint - result.per_radian * seen.at;
  return result;
}

JointRange joint_range(const ServoSettings& servo) {
  const ServoMap map(servo);
  const auto [min, max] = std::minmax({map.joint(servo.min), map.joint(servo.max)});
  return {min, max};
}

ServoCalibration::ServoCalibration(std::shared_ptr<const Device> device, const std::string& port,
                                   const std::atomic<bool>& stop)
    : device_(std::move(device)), stop_(stop) {
  const auto& transport = device_->settings().transport;
  if (!transport || transport->follows_travel) {
    throw InputError("this device has no servos that move joints: nothing to calibrate");
  }
  if (!device_->inverse_kinematics(device_->home(), home_)) {
    throw InputError("this device's home has no joint angles: nothing to calibrate from");
  }
  std::vector<EmulatedServo> emulated;
  for (const ServoSettings& servo : transport->servos) {
    maps_.emplace_back(servo);
    const auto joint = static_cast<Eigen::Index>(emulated.size());
    emulated.push_back({.channel = servo.channel,
                        .initial_setpoint = maps_.back().setpoint(home_[joint]),
                        .rate = device_->joint_limits().max_rate * std::abs(servo.per_radian),
                        .step = servo.step});
  }
  bus_ = make_servo_bus(*transport);
  std::string name = port.empty() ? transport->port : port;
  if (name == "emulator") {
    emulated_ = std::make_unique<EmulatedBus>(*transport, emulated);
    name = emulated_->port();
  }
  const std::string reason = bus_->open(name);
  if (!reason.empty()) throw InputError(fmt::format("port {} cannot be opened: {}", name, reason));
  // Slowly from where the servos say they are; those that say nothing go at once.
  now_ = home_;
  std::array<std::int32_t, kMostServos> positions{};
  if (bus_->ask()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    if (bus_->take_positions(std::span(positions).first(maps_.size()))) {
      for (std::size_t i = 0; i < maps_.size(); ++i) {
        now_[static_cast<Eigen::Index>(i)] = maps_[i].joint_of_target(positions[i]);
      }
    }
  }
  try {
    go(home_);
  } catch (...) {
    retract();
    throw;
  }
}

ServoCalibration::~ServoCalibration() { retract(); }

void ServoCalibration::retract() noexcept {
  JointAngles joints;
  if (!device_->inverse_kinematics(device_->retracted(), joints)) return;
  try {
    while (bus_->is_open() && !step(joints, kAway)) continue;
    for (int k = 0; k < kRepeats; ++k) step(joints, kAway);  // servos are behind
  } catch (const std::exception&) {
    return;  // the port is gone
  }
}

bool ServoCalibration::step(const JointAngles& joints, double speed) {
  const JointLimits& limits = device_->joint_limits();
  const double most = speed * limits.max_rate / kCommandsPerSecond;
  const JointAngles left = joints - now_;
  const bool arrived = left.cwiseAbs().maxCoeff() <= most;
  now_ = arrived ? joints : JointAngles(now_ + left.cwiseMax(-most).cwiseMin(most));
  std::array<std::int32_t, kMostServos> targets{};
  for (std::size_t i = 0; i < maps_.size(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    targets[i] = maps_[i].target(now_[joint], limits.min[joint], limits.max[joint]);
  }
  bus_->write(std::span(targets).first(maps_.size()));
  if (!bus_->is_open()) throw OperationError("the port vanished");
  bus_->drain();
  std::this_thread::sleep_for(std::chrono::duration<double>(1.0 / kCommandsPerSecond));
  return arrived;
}

void ServoCalibration::go(const JointAngles& joints) {
  while (!step(joints, kSlow)) {
    if (stop_.load()) throw OperationError("calibrate: ended before it was done; nothing written");
  }
}

double ServoCalibration::move_away(int servo) {
  const JointLimits& limits = device_->joint_limits();
  const double step = limits.linear ? kStepMillimetres * mm : kStepDegrees * deg;
  for (double part = 1.0; part >= kLeastStep; part *= 0.5) {
    for (const double by : {part * step, -part * step}) {
      JointAngles joints = home_;
      joints[servo] += by;
      Configuration q;
      if (joints[servo] < limits.min[servo] || joints[servo] > limits.max[servo] ||
          !device_->forward_kinematics(joints, q)) {
        continue;
      }
      go(joints);
      return by;
    }
  }
  throw InputError(fmt::format("joint {} cannot move alone from home", servo + 1));
}

void ServoCalibration::move_back() { go(home_); }

ServoSettings ServoCalibration::calibrated_servo(int servo, const ServoSighting& seen) const {
  const ServoSettings& settings =
      device_->settings().transport->servos[static_cast<std::size_t>(servo)];
  return calibrated(settings, maps_[static_cast<std::size_t>(servo)].setpoint(home_[servo]), seen);
}

}  // namespace softfinger
