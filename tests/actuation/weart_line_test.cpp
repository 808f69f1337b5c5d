// The way from the loop by WEART's middleware to an emulated TouchDIVER.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <thread>
#include <vector>

#include "../support/lever_platform.hpp"
#include "softfinger/actuation/actuator.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/motors/emulation/emulator_socket.hpp"
#include "softfinger/motors/servo_map.hpp"
#include "softfinger/motors/weart/weart_emulator.hpp"

namespace softfinger {
namespace {

bool sooner_or_later(const std::function<bool()>& done) {
  for (int i = 0; i < 2000; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

EmulatedServo cap() { return {.initial_setpoint = 0.0, .rate = 20.0, .step = 1e-6}; }

TEST(WeartBus, TravelBecomesForceAndTheEndLetsGo) {
  const auto device = lever_platform({.rate = 100.0, .kind = "weart"});
  const ServoMap map(device->settings().transport->servos.front());
  WeartEmulator emulator(*device->settings().transport, cap());
  EmulatorSocket socket(emulator, EmulatorSocket::Kind::kTcp);
  {
    Actuator actuator(device, {.port = socket.port()});
    EXPECT_TRUE(actuator.connected());
    double time = 0.0;
    for (const double travel : {2.0 * mm, 4.0 * mm}) {
      const Configuration wanted = Eigen::Vector3d(3 * deg, 0.0, travel);
      EXPECT_TRUE(sooner_or_later([&] {
        actuator.command({.configuration = wanted, .touching = true}, time += 0.01);
        return std::abs(emulator.setpoint(0) - map.setpoint(travel)) < 0.005;
      })) << travel;
      EXPECT_NEAR(map.setpoint(travel), 0.1 * travel / mm, 1e-9);
    }
    // Whatever is wanted, the force stays below its cut.
    for (int k = 0; k < 50; ++k) {
      actuator.command({.configuration = Eigen::Vector3d(0, 0, k % 2 == 0 ? 1e30 : 0.1)},
                       time += 0.01);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  EXPECT_LE(emulator.largest(), 0.9 + 1e-9);
  EXPECT_TRUE(sooner_or_later([&] { return !emulator.started(); }));
  EXPECT_GT(emulator.stops(), 0u);
  EXPECT_EQ(emulator.refused(), 0u);
  EXPECT_TRUE(sooner_or_later([&] { return emulator.setpoint(0) < 0.001; }));
}

TEST(WeartBus, EmbeddedEmulatorFollows) {
  const auto device = lever_platform({.rate = 100.0, .kind = "weart"});
  for (const bool simulated : {false, true}) {
    Actuator actuator(device, {.simulated_time = simulated});
    const Configuration wanted = Eigen::Vector3d(0.0, 0.0, 4.0 * mm);
    double time = 0.0;
    EXPECT_TRUE(sooner_or_later([&] {
      actuator.command({.configuration = wanted, .touching = true}, time += 0.01);
      JointAngles joints;
      Configuration q;
      return actuator.read_servo_joints(joints) && device->forward_kinematics(joints, q) &&
             std::abs(q[2] - wanted[2]) < 0.05 * mm;
    })) << simulated;
  }
}

TEST(WeartBus, MiddlewareGoesAndComesBack) {
  const auto device = lever_platform({.rate = 100.0, .kind = "weart"});
  WeartEmulator emulator(*device->settings().transport, cap());
  auto socket = std::make_unique<EmulatorSocket>(emulator, EmulatorSocket::Kind::kTcp);
  Actuator actuator(device, {.port = socket->port()});
  double time = 0.0;
  const auto drive = [&] {
    actuator.command({.configuration = device->home(), .touching = true}, time += 0.01);
  };
  EXPECT_TRUE(sooner_or_later([&] {
    drive();
    return emulator.commands() > 3;
  }));
  socket->vanish();
  EXPECT_TRUE(sooner_or_later([&] {
    drive();
    return !actuator.connected();
  }));
  EXPECT_EQ(actuator.take_event(), ActuatorEvent::kPortLost);
  EXPECT_EQ(actuator.state(), DeviceState::kDisconnected);
}

TEST(WeartBus, SaysThatNobodyListens) {
  const auto device = lever_platform({.kind = "weart"});
  std::string port;
  {
    WeartEmulator emulator(*device->settings().transport, cap());
    EmulatorSocket socket(emulator, EmulatorSocket::Kind::kTcp);
    port = socket.port();
  }
  try {
    Actuator actuator(device, {.port = port});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr(port), testing::HasSubstr("WEART middleware")));
  }
}

}  // namespace
}  // namespace softfinger
