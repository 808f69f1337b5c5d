// Set points by Open Sound Control: bytes of the specification, and the way from the loop to an
// emulated listener.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>
#include <thread>
#include <vector>

#include "lever_platform.hpp"
#include "softfinger/actuation/actuator.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/motors/emulation/emulator_socket.hpp"
#include "softfinger/motors/osc/osc_bundle.hpp"
#include "softfinger/motors/osc/osc_emulator.hpp"
#include "softfinger/motors/servo_map.hpp"

namespace softfinger {
namespace {

using OscBytes = std::vector<std::uint8_t>;

OscBytes bundle_of(const std::vector<OscFloat>& messages) {
  OscBytes bytes(osc_bundle_size(messages));
  EXPECT_EQ(encode_osc_bundle(messages, bytes), bytes.size());
  return bytes;
}

// "The Open Sound Control 1.0 Specification": strings padded with one to four zeros, big endian,
// the time tag "immediately".
TEST(OscBundle, SaysTheBytesOfTheSpecification) {
  EXPECT_EQ(bundle_of({{"/a", 1.0F}}),
            (OscBytes{'#', 'b', 'u', 'n', 'd', 'l', 'e', 0, 0,   0,   0, 0, 0,    0,    0, 1,
                      0,   0,   0,   12,  '/', 'a', 0,   0, ',', 'f', 0, 0, 0x3F, 0x80, 0, 0}));
  // An address of four letters gets four zeros.
  EXPECT_EQ(osc_bundle_size(std::vector<OscFloat>{{"/abc", 0.0F}}), 16u + 4 + 8 + 4 + 4);
  EXPECT_EQ(osc_bundle_size(std::vector<OscFloat>{}), 16u);
}

TEST(OscBundle, ReadsWhatItWrites) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(-1e6F, 1e6F);
  for (int i = 0; i < 500; ++i) {
    std::vector<std::string> addresses;
    for (unsigned k = random() % 8; k > 0; --k) {
      addresses.push_back("/" + std::string(random() % 20, static_cast<char>('a' + random() % 26)));
    }
    std::vector<OscFloat> messages;
    for (const std::string& address : addresses) messages.push_back({address, uniform(random)});
    const OscBytes bytes = bundle_of(messages);
    const auto read = decode_osc_bundle(bytes);
    ASSERT_TRUE(read);
    ASSERT_EQ(read->size(), messages.size());
    for (std::size_t k = 0; k < messages.size(); ++k) {
      EXPECT_EQ((*read)[k].address, messages[k].address);
      EXPECT_EQ((*read)[k].value, messages[k].value);
    }
  }
}

TEST(OscBundle, RefusesWhatIsCutOrLies) {
  const OscBytes good = bundle_of({{"/joint/1", 1.0F}, {"/joint/2", 2.0F}});
  for (std::size_t size = 0; size < good.size(); ++size) {
    // Only a cut between two messages leaves a bundle.
    const bool whole = size == 16 || size == 16 + 4 + 12 + 4 + 4;
    EXPECT_EQ(decode_osc_bundle(std::span(good).first(size)).has_value(), whole) << size;
  }
  for (const auto& [at, byte] : std::vector<std::pair<std::size_t, int>>{
           {0, '/'}, {16, 0xFF}, {19, 8}, {20, 'j'}, {30, 1}, {32, 'f'}, {33, 'i'}, {35, 1}}) {
    OscBytes bad = good;
    bad[at] = static_cast<std::uint8_t>(byte);
    EXPECT_FALSE(decode_osc_bundle(bad)) << at;
  }
}

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
