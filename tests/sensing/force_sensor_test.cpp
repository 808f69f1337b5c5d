// Force sensors on their wires, each with its emulator at the far end.

#include "softfinger/sensing/force_sensor.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "softfinger/base/error.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/sensing/force_sensor_emulator.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

bool comes_true(const std::function<bool()>& condition) {
  for (int i = 0; i < 400; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

ForceSensorSettings settings_of(ForceSensorKind kind) {
  ForceSensorSettings settings;
  settings.kind = kind;
  settings.rate = 500.0;
  return settings;
}

class OnAWire : public testing::TestWithParam<ForceSensorKind> {};

TEST_P(OnAWire, SaysWhatItIsPressedWith) {
  ForceSensorSettings settings = settings_of(GetParam());
  settings.scale = 2.0;
  settings.zero = 0.25;
  ForceSensor sensor(settings);
  sensor.emulator()->press(0.75);
  EXPECT_TRUE(comes_true([&] { return std::abs(sensor.look().force - 1.0) < 1e-6; }));
  EXPECT_TRUE(sensor.is_fresh(sensor.look(), monotonic_time()));
  EXPECT_GT(sensor.look().count, 0U);
}

TEST_P(OnAWire, IsStaleOnceItIsSilent) {
  ForceSensor sensor(settings_of(GetParam()));
  ASSERT_TRUE(comes_true([&] { return sensor.look().count > 0; }));
  sensor.emulator()->fail(ForceSensorFault::kSilent);
  EXPECT_TRUE(comes_true([&] { return !sensor.is_fresh(sensor.look(), monotonic_time()); }));
}

TEST_P(OnAWire, WhatNoFingerIsPressedWithIsRefused) {
  ForceSensor sensor(settings_of(GetParam()));
  sensor.emulator()->press(2.0 * ForceSensorSettings::kLargestForce);
  EXPECT_TRUE(comes_true([&] { return sensor.look().refused > 0; }));
  EXPECT_LE(std::abs(sensor.look().force), ForceSensorSettings::kLargestForce);
}

INSTANTIATE_TEST_SUITE_P(Kinds, OnAWire,
                         testing::Values(ForceSensorKind::kUdp, ForceSensorKind::kOsc,
                                         ForceSensorKind::kSerial),
                         [](const auto& kind) {
                           return std::string(row_of(kForceSensorKinds, kind.param).name);
                         });

TEST(ForceSensor, ListensToThisMachineAlone) {
  const ForceSensor any(settings_of(ForceSensorKind::kUdp));
  EXPECT_TRUE(any.port().starts_with("127.0.0.1:"));
  ForceSensorSettings same = settings_of(ForceSensorKind::kUdp);
  same.port = any.port().substr(any.port().find(':') + 1);
  EXPECT_THROW(ForceSensor{same}, InputError) << "the port is taken";
}

TEST(ForceSensor, HearsOneSenderAtATime) {
  ForceSensorSettings settings = settings_of(ForceSensorKind::kUdp);
  ForceSensor sensor(settings);
  ASSERT_TRUE(comes_true([&] { return sensor.look().count > 0; }));
  Endpoint at;
  ASSERT_EQ(find_endpoint(sensor.port(), at), "");
  UdpSocket stranger({kLoopback, 0});
  const std::string line = "55\n";
  for (int i = 0; i < 50; ++i) {
    stranger.send(at, {reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_EQ(sensor.look().force, 0.0);
  }
}

TEST(ForceSensor, ASerialPortThatIsNotThereIsNamed) {
  ForceSensorSettings settings = settings_of(ForceSensorKind::kSerial);
  settings.port = "/dev/no-such-port";
  try {
    const ForceSensor sensor(settings);
    FAIL() << "opened";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("/dev/no-such-port"), std::string::npos);
  }
}

ForceSensorSettings read(const std::string& text) {
  const ConfigFile file("device.toml", "[force_sensor]\n" + text);
  const ConfigTable root = file.root();
  const ForceSensorSettings settings = read_force_sensor(root.table("force_sensor"));
  root.finish();
  return settings;
}

TEST(ForceSensorFile, AnAddressIsAPortOrAddressAndPort) {
  EXPECT_EQ(read("kind = \"udp\"\nport = 9100\n").port, "9100");
  EXPECT_EQ(read("kind = \"osc\"\nport = \"192.168.1.5:9100\"\n").port, "192.168.1.5:9100");
  EXPECT_TRUE(read("kind = \"serial\"\n").is_emulated());
  EXPECT_EQ(read("kind = \"serial\"\nport = \"/dev/ttyUSB0\"\nbaud = 9600\n").baud, 9600U);
  EXPECT_DOUBLE_EQ(read("kind = \"udp\"\nrate_Hz = 10.0\n").stale, 0.3) << "three readings";
}

TEST(ForceSensorFile, WhatIsWrongIsNamed) {
  const auto refused = [](const std::string& text, const std::string& word) {
    try {
      (void)read(text);
      ADD_FAILURE() << text << " was read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  refused("kind = \"usb\"\n", "serial");
  refused("kind = \"udp\"\nport = 0\n", "force_sensor.port");
  refused("kind = \"udp\"\nport = 70000\n", "force_sensor.port");
  refused("kind = \"udp\"\nport = \"9100x\"\n", "ADDRESS:PORT");
  refused("kind = \"serial\"\nport = 9100\n", "serial port");
  refused("kind = \"emulator\"\nport = 9100\n", "leave it out");
  refused("kind = \"udp\"\nrate_Hz = 10.0\nstale_ms = 50.0\n", "stale_ms");
  refused("kind = \"udp\"\nscale_N = \"one\"\n", "scale_N");
}

TEST(FaultyForce, SaysMoreOfAForceThatFallsThanOfOneThatGrows) {
  FaultyForce says(0.0, 1, 0.1);
  for (const double force : {0.2, 0.6, 1.0}) {
    EXPECT_NEAR(says.reading(force).value(), 0.95 * force, 1e-12) << "grows";
  }
  EXPECT_NEAR(says.reading(0.95).value(), 0.95, 1e-12) << "as it turns, it says the same";
  for (const double force : {0.8, 0.3}) {
    EXPECT_NEAR(says.reading(force).value(), 1.05 * force, 1e-12) << "falls";
  }
  EXPECT_EQ(says.reading(0.0).value(), 0.0) << "nothing is left";
}

}  // namespace
}  // namespace softfinger
