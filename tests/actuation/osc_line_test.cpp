// Set points by Open Sound Control: the way from the loop to an emulated listener.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>
#include <thread>
#include <vector>

#include "../support/lever_platform.hpp"
#include "softfinger/actuation/actuator.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/motors/emulation/emulator_socket.hpp"
#include "softfinger/motors/osc/osc_emulator.hpp"
#include "softfinger/motors/servo_map.hpp"

namespace softfinger {
namespace {

bool eventually(const std::function<bool()>& done) {
  for (int i = 0; i < 2000; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

std::vector<EmulatedServo> osc_servos(const Device& device) {
  std::vector<EmulatedServo> servos;
  JointAngles home;
  EXPECT_TRUE(device.inverse_kinematics(device.home(), home));
  for (const ServoSettings& settings : device.settings().transport->servos) {
    const auto joint = home[static_cast<Eigen::Index>(servos.size())];
    servos.push_back({.initial_setpoint = ServoMap(settings).setpoint(joint),
                      .rate = 600.0,
                      .step = settings.step});
  }
  return servos;
}

TEST(OscBus, JointAnglesInDegreesReachTheListenerWithinLimits) {
  const auto device = lever_platform({.rate = 100.0, .kind = "osc"});
  OscEmulator emulator(*device->settings().transport, osc_servos(*device));
  EmulatorSocket socket(emulator, EmulatorSocket::Kind::kUdp);
  Actuator actuator(device, {.port = socket.port()});
  EXPECT_TRUE(actuator.connected());
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double time = 0.0;
  for (int k = 0; k < 150; ++k) {
    Configuration q(3);
    for (int i = 0; i < 3; ++i) q[i] = uniform(random);
    if (k % 4 == 0) q[k % 3] = std::numeric_limits<double>::quiet_NaN();
    actuator.command({.configuration = q}, time += 0.01);
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 8));
  }
  const Configuration wanted = Eigen::Vector3d(5 * deg, -3 * deg, 2 * mm);
  JointAngles goal;
  ASSERT_TRUE(device->inverse_kinematics(wanted, goal));
  EXPECT_TRUE(eventually([&] {
    actuator.command({.configuration = wanted}, time += 0.01);
    double worst = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      worst = std::max(worst,
                       std::abs(emulator.setpoint(i) * deg - goal[static_cast<Eigen::Index>(i)]));
    }
    return worst < 0.1 * deg;
  }));
  EXPECT_EQ(emulator.malformed(), 0u);
  EXPECT_GT(emulator.bundles(), 20u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GE(emulator.least(i), -20.0 - 1e-4);
    EXPECT_LE(emulator.largest(i), 90.0 + 1e-4);
  }
}

TEST(OscBus, ARunGoesOnWhereNobodyListens) {
  const auto device = lever_platform({.rate = 100.0, .kind = "osc"});
  std::string port;
  {
    OscEmulator emulator(*device->settings().transport, osc_servos(*device));
    EmulatorSocket socket(emulator, EmulatorSocket::Kind::kUdp);
    port = socket.port();
  }
  Actuator actuator(device, {.port = port});
  double time = 0.0;
  EXPECT_TRUE(eventually([&] {
    actuator.command({.configuration = device->home()}, time += 0.01);
    return actuator.commands_sent() > 5;
  }));
  EXPECT_TRUE(actuator.connected());
}

TEST(OscBus, RefusesWhatIsNoAddress) {
  for (const char* port :
       {"nowhere", ":9000", "127.0.0.1:", "127.0.0.1:0", "127.0.0.1:70000", "127.0.0.1:9x"}) {
    try {
      Actuator actuator(lever_platform({.kind = "osc"}), {.port = port});
      FAIL() << port;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("HOST:PORT"));
    }
  }
}

}  // namespace
}  // namespace softfinger
