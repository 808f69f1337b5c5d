// The NatNet client against an emulated server, over sockets of this machine.
#include "softfinger/tracking/natnet/natnet_tracker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <tuple>

#include "softfinger/base/error.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/tracking/natnet/natnet_emulator.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;

/// Goes along x at 10 mm/s, turning about z; so x tells the time.
TrackedPose along_x(double time) {
  return {.time = time,
          .X_WFt = {exp_rotation({0.0, 0.0, 0.1 * time}), {0.01 * time, 0.02, 0.03}},
          .valid = true};
}

TrackerSpec spec_for(const NatNetEmulator& emulator) {
  return {.kind = TrackerKind::kNatnet, .port = emulator.address().port, .body = "index"};
}

/// Why the tracker does not start.
std::string refusal(const TrackerSpec& spec) {
  try {
    const NatNetTracker tracker(spec, 0.4);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

void pause_ms(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

/// Whether datagrams to a multicast group come back on this machine's loopback.
bool loopback_has_multicast() {
  try {
    UdpSocket receiver({kNatNetGroup, 0}, true);
    receiver.join(kNatNetGroup, kLoopback);
    UdpSocket sender({kLoopback, 0});
    sender.send_multicast_from(kLoopback);
    const std::array<std::uint8_t, 4> bytes{1, 2, 3, 4};
    sender.send({kNatNetGroup, receiver.local().port}, bytes);
    const std::array<int, 1> sockets{receiver.descriptor()};
    wait_for_datagram(sockets, 5.0);
    std::array<std::uint8_t, 16> buffer{};
    return receiver.receive(buffer).has_value();
  } catch (const InputError&) {
    return false;
  }
}

enum class Way { kUnicast, kUnicastToDataPort, kMulticast };

class NatNetOver : public testing::TestWithParam<std::tuple<Way, NatNetVersion, UpAxis>> {};

TEST_P(NatNetOver, LoopbackTheBodyIsWhereTheServerSeesIt) {
  const auto& [way, version, up] = GetParam();
  if (way == Way::kMulticast && !loopback_has_multicast()) {
    GTEST_SKIP() << "loopback of this machine passes no multicast";
  }
  NatNetEmulator emulator({.version = version,
                           .multicast = way == Way::kMulticast,
                           .to_data_port = way == Way::kUnicastToDataPort,
                           .up = up,
                           .scale = 0.001},
                          along_x);
  TrackerSpec spec = spec_for(emulator);
  spec.up = up;
  spec.scale = 0.001;
  NatNetTracker tracker(spec, 20.0);
  double last = 0.0;
  int valid = 0;
  for (int i = 0; i < 100 && valid < 20; ++i) {
    pause_ms(20);
    const TrackedPose pose = tracker.sample(monotonic_time());
    if (!pose.valid) continue;
    ++valid;
    const double time = pose.X_WFt.translation.x() / 0.01;
    EXPECT_GE(time, last);
    last = time;
    // All of the pose belongs to one time, which x tells: K's axes and unit are undone.
    EXPECT_LT((pose.X_WFt.translation - Vector3(0.01 * time, 0.02, 0.03)).norm(), 1e-6);
    EXPECT_LT((pose.X_WFt.rotation - exp_rotation({0.0, 0.0, 0.1 * time})).norm(), 1e-5);
  }
  EXPECT_GE(valid, 20);
  EXPECT_GT(last, 0.1);
}

INSTANTIATE_TEST_SUITE_P(
    Sockets, NatNetOver,
    testing::Values(std::tuple{Way::kUnicast, NatNetVersion{3, 0}, UpAxis::kY},
                    std::tuple{Way::kUnicast, NatNetVersion{4, 4}, UpAxis::kZ},
                    std::tuple{Way::kUnicastToDataPort, NatNetVersion{4, 0}, UpAxis::kY},
                    std::tuple{Way::kMulticast, NatNetVersion{3, 1}, UpAxis::kZ},
                    std::tuple{Way::kMulticast, NatNetVersion{4, 1}, UpAxis::kY},
                    std::tuple{Way::kMulticast, NatNetVersion{4, 2}, UpAxis::kY}));

// The clocks of server and client are a day apart; the age of a pose is that of its exposure.
TEST(NatNetTracker, PoseAgeIsThatOfTheExposure) {
  NatNetEmulator emulator({.exposure_age = 0.1, .clock_ahead = 86400.0}, along_x);
  NatNetTracker tracker(spec_for(emulator), 20.0);
  pause_ms(200);
  double least = 1.0;
  for (int i = 0; i < 100; ++i) {
    pause_ms(5);
    const double now = monotonic_time();
    least = std::min(least, now - tracker.sample(now).time);
  }
  EXPECT_GE(least, 0.09);
  EXPECT_LT(least, 0.15);
}

TEST(NatNetTracker, PosesNeverGoBackUnderLossDoublingAndReordering) {
  NatNetEmulator emulator({.rate = 500.0, .loss = 0.3, .duplication = 0.2, .reordering = 0.2},
                          along_x);
  NatNetTracker tracker(spec_for(emulator), 20.0);
  double last = 0.0;
  int moved = 0;
  for (int i = 0; i < 1500; ++i) {
    pause_ms(1);
    const TrackedPose pose = tracker.sample(monotonic_time());
    ASSERT_GE(pose.X_WFt.translation.x(), last);
    moved += pose.X_WFt.translation.x() > last;
    last = pose.X_WFt.translation.x();
  }
  EXPECT_GT(moved, 50);
}

TEST(NatNetTracker, IsLostWhileTheServerDoesNotSeeTheBody) {
  NatNetEmulator emulator({}, [](double time) {
    TrackedPose pose = along_x(time);
    pose.valid = std::fmod(time, 1.0) < 0.5;
    return pose;
  });
  NatNetTracker tracker(spec_for(emulator), 20.0);
  bool lost = false, found = false;
  for (int i = 0; i < 1000 && !(lost && found); ++i) {
    pause_ms(5);
    const TrackedPose pose = tracker.sample(monotonic_time());
    found = found || (lost && pose.valid);
    lost = lost || (pose.X_WFt.translation.x() > 0.0 && !pose.valid);
  }
  EXPECT_TRUE(lost);
  EXPECT_TRUE(found);
}

TEST(NatNetTracker, AServerThatEndsIsToldAndAnotherInItsPlaceIsFound) {
  auto emulator = std::make_unique<NatNetEmulator>(NatNetEmulator::Options{}, along_x);
  const std::uint16_t port = emulator->address().port;
  NatNetTracker tracker(spec_for(*emulator), 20.0);
  EXPECT_FALSE(tracker.take_message().has_value());
  emulator.reset();
  std::string told;
  const auto listen = [&] {
    told.clear();
    for (int i = 0; i < 2000 && told.empty(); ++i) {
      pause_ms(10);
      told = tracker.take_message().value_or("");
    }
  };
  listen();
  EXPECT_THAT(told, HasSubstr("silent"));
  EXPECT_FALSE(tracker.sample(monotonic_time()).valid);
  // Another version, and a clock that starts anew.
  const NatNetEmulator other({.port = port, .version = {3, 1}, .clock_ahead = 5.0}, along_x);
  listen();
  EXPECT_THAT(told, HasSubstr("again"));
  pause_ms(100);
  EXPECT_GT(tracker.sample(monotonic_time()).X_WFt.translation.x(), 0.0);
}

TEST(NatNetTracker, SaysWhichBodiesThereAre) {
  const NatNetEmulator emulator({.body = "index tip"}, along_x);
  EXPECT_THAT(refusal(spec_for(emulator)),
              HasSubstr("no rigid body 'index'; there are index tip (another), index tip"));
}

TEST(NatNetTracker, SaysWhichSocketIsSilentAndWhy) {
  TrackerSpec nobody{.kind = TrackerKind::kNatnet, .body = "index"};
  nobody.port = UdpSocket({kLoopback, 0}).local().port;
  const std::string silent = refusal(nobody);
  EXPECT_THAT(silent, HasSubstr("command socket is silent"));
  EXPECT_THAT(silent, HasSubstr("firewall"));
  EXPECT_THAT(silent, HasSubstr(std::to_string(nobody.port)));

  const NatNetEmulator mute({.mute = true}, along_x);
  const std::string unicast = refusal(spec_for(mute));
  EXPECT_THAT(unicast, HasSubstr("data socket is silent"));
  EXPECT_THAT(unicast, HasSubstr("unicast"));

  TrackerSpec multicast = spec_for(mute);
  multicast.multicast = true;
  EXPECT_THAT(refusal(multicast), HasSubstr("no multicast at 239.255.42.99"));
}

TEST(NatNetTracker, SaysWhichVersionsItKnows) {
  const NatNetEmulator emulator({.version = {2, 9}}, along_x);
  EXPECT_THAT(refusal(spec_for(emulator)), HasSubstr("speaks NatNet 2.9, this program 3.0 to 4.2"));
}

TEST(NatNetTracker, RefusesAHostThatIsNone) {
  TrackerSpec spec{.kind = TrackerKind::kNatnet, .address = "no.such.host.invalid", .port = 1};
  EXPECT_THAT(refusal(spec), HasSubstr("no.such.host.invalid"));
}

}  // namespace
}  // namespace softfinger
