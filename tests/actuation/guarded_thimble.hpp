#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <thread>
#include <vector>

#include "../support/folders.hpp"
#include "../support/maestro_terminal.hpp"
#include "softfinger/actuation/actuator.hpp"
#include "softfinger/actuation/guard_setup.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/motors/servo_map.hpp"

namespace softfinger {

inline const std::filesystem::path kThimble =
    std::filesystem::path(source_folder()) / "devices" / "thimble-3rrs.toml";
inline constexpr double kNear = 0.01;  ///< rad

/// Of this process.
inline std::ptrdiff_t open_descriptors() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                       std::filesystem::directory_iterator());
}

/// A thimble whose Maestro is emulated, for a guard process to own the port of.
class GuardedThimble : public ::testing::Test {
 protected:
  static std::vector<EmulatedServo> servos_of(const Device& device, const Configuration& q) {
    std::vector<EmulatedServo> servos;
    const JointAngles joints = joints_of(device, q);
    for (const ServoSettings& settings : device.settings().transport->servos) {
      const ServoMap map(settings);
      servos.push_back({.channel = map.channel(),
                        .initial_setpoint = map.setpoint(joints[Eigen::Index(servos.size())])});
    }
    return servos;
  }
  static JointAngles joints_of(const Device& device, const Configuration& q) {
    JointAngles joints;
    EXPECT_TRUE(device.inverse_kinematics(q, joints));
    return joints;
  }
  /// How far the emulated servos are from where q has them, rad.
  double away_from(const Configuration& q) const {
    const JointAngles joints = joints_of(*device, q);
    double farthest = 0.0;
    for (Eigen::Index i = 0; i < joints.size(); ++i) {
      const ServoMap map(device->settings().transport->servos[static_cast<std::size_t>(i)]);
      const double servo = map.joint(terminal.emulator().servo_pulse(map.channel()));
      farthest = std::max(farthest, std::abs(servo - joints[i]));
    }
    return farthest;
  }
  ActuatorOptions options() const {
    return {.port = terminal.port(), .device_file = kThimble, .guard_program = guard_program()};
  }
  GuardSetup setup() const {
    return {.device_file = kThimble,
            .device_text = device->settings().text,
            .line = {.port = terminal.port()}};
  }
  /// Commands q at every tick until `done`; false where it never is.
  static bool follow(Actuator& actuator, const Configuration& q,
                     const std::function<bool()>& done) {
    for (int k = 0; k < 300; ++k) {
      actuator.command({.configuration = q, .touching = true}, time_ += 1.0 / 30.0);
      std::this_thread::sleep_for(std::chrono::milliseconds(33));
      if (done()) return true;
    }
    return false;
  }
  static bool soon(const std::function<bool()>& done) {
    for (int i = 0; i < 2000; ++i) {
      if (done()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }

  std::shared_ptr<const Device> device = load_device(kThimble);
  MaestroTerminal terminal{servos_of(*device, device->home())};
  Configuration wanted = [this] {
    Configuration q = device->home();
    q[0] += 0.1;
    return q;
  }();
  static inline double time_ = 0.0;
};

}  // namespace softfinger
