#include "softfinger/tracking/stream/pose_listener.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/tracking/make_tracker.hpp"
#include "softfinger/tracking/stream/osc_pose.hpp"
#include "softfinger/tracking/stream/pose_datagram.hpp"

namespace softfinger {
namespace {

constexpr Endpoint kAnywhere{kLoopback, 0};
constexpr Endpoint kSender{kLoopback, 5000};

PoseMessage at(double x, std::uint32_t sequence, double sent = 0.0) {
  return {.X_WFt = {Matrix3::Identity(), {x, 0.0, 0.0}},
          .valid = true,
          .sequence = sequence,
          .time = sent};
}

TEST(PoseFeed, IsLostWithoutAValidPoseAndHoldsTheLast) {
  PoseFeed feed;
  EXPECT_FALSE(feed.sample(0.0, 100.0).valid);
  feed.offer({Matrix3::Identity(), {0.1, 0, 0}}, 100.490, 100.500);
  const TrackedPose first = feed.sample(0.510, 100.510);
  EXPECT_TRUE(first.valid);
  EXPECT_NEAR(first.time, 0.490, 1e-9) << "when it was true, not when it came";
  EXPECT_TRUE(feed.sample(0.69, 100.69).valid);
  EXPECT_NEAR(feed.sample(0.69, 100.69).time, 0.490, 1e-9);
  EXPECT_FALSE(feed.sample(0.71, 100.71).valid);
  EXPECT_EQ(feed.sample(0.71, 100.71).X_WFt.translation.x(), 0.1);
  // Simulated time may stand still while the wall's goes on.
  feed.offer({Matrix3::Identity(), {0.2, 0, 0}}, 101.0, 101.0);
  EXPECT_TRUE(feed.sample(0.711, 101.0).valid);
  EXPECT_FALSE(feed.sample(0.712, 105.0).valid);
  feed.offer({Matrix3::Identity(), {0.3, 0, 0}}, 105.0, 105.0);
  feed.lose();
  const TrackedPose lost = feed.sample(0.72, 105.01);
  EXPECT_FALSE(lost.valid);
  EXPECT_EQ(lost.X_WFt.translation.x(), 0.3) << "the last known, though never sampled";
}

TEST(SequenceGate, LetsOnlyNewerThrough) {
  SequenceGate gate;
  EXPECT_TRUE(gate.admits(0xfffffffe, 0.0));
  EXPECT_FALSE(gate.admits(0xfffffffe, 0.01)) << "twice";
  EXPECT_TRUE(gate.admits(1, 0.01)) << "wraps around";
  EXPECT_FALSE(gate.admits(0xffffffff, 0.02)) << "overtaken";
  EXPECT_TRUE(gate.admits(500, 0.02));
  EXPECT_FALSE(gate.admits(3, 0.1)) << "restarted, but the old may still be there";
  EXPECT_TRUE(gate.admits(4, 0.23));
  EXPECT_TRUE(gate.restarted());
  EXPECT_FALSE(gate.admits(3, 0.24));
  EXPECT_FALSE(gate.admits(4, 0.99)) << "the last one again is no restart";
  EXPECT_TRUE(gate.admits(5, 0.99));
  EXPECT_FALSE(gate.restarted());
}

TEST(SenderClock, TakesTheLeastDelayForNone) {
  SenderClock clock;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> delay(0.001, 0.030);
  double worst = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double truth = 50.0 + 0.01 * i;
    const double sent = truth + 12345.0;  // another clock
    const double received = truth + delay(random);
    const double local = clock.local_time(sent, received);
    ASSERT_LE(local, received);
    if (i > 100) worst = std::max(worst, std::abs(local - truth));
  }
  EXPECT_LT(worst, 0.003) << "the least of a hundred delays is near the least of all";
  // The sender's clock is set back: poses do not become a minute old.
  EXPECT_GT(clock.local_time(70.0, 71.0), 70.9);
}

TEST(PoseReception, TheFirstSenderKeepsThePortWhileItSends) {
  PoseReception reception;
  PoseFeed feed;
  const Endpoint second{kLoopback, 5001};
  reception.receive(at(0.1, 10), kSender, 1.00, feed);
  reception.receive(at(0.2, 999), second, 1.01, feed);
  EXPECT_EQ(feed.sample(0.0, 1.01).X_WFt.translation.x(), 0.1);
  reception.receive(at(0.3, 11), kSender, 1.15, feed);
  reception.receive(at(0.4, 1000), second, 1.30, feed);
  EXPECT_EQ(feed.sample(0.3, 1.30).X_WFt.translation.x(), 0.3);
  reception.receive(at(0.5, 1), second, 1.36, feed);
  EXPECT_EQ(feed.sample(0.36, 1.36).X_WFt.translation.x(), 0.5) << "silent for over 200 ms";
  PoseMessage lost = at(0.0, 2);
  lost.valid = false;
  reception.receive(lost, second, 1.37, feed);
  EXPECT_FALSE(feed.sample(0.37, 1.37).valid);
}

TEST(PoseReception, UnderLossAndReorderingThePoseIsNeverOlderThanTheNewest) {
  PoseReception reception;
  PoseFeed feed;
  std::mt19937 random(11);
  std::uint32_t newest = 0;
  std::vector<std::uint32_t> late;
  for (std::uint32_t n = 1; n < 20000; ++n) {
    const double now = 0.004 * n;
    std::vector<std::uint32_t> arriving;
    if (random() % 10 < 3) continue;  // lost
    if (random() % 10 < 2) {
      late.push_back(n);
    } else {
      arriving.push_back(n);
      if (random() % 10 == 0) arriving.push_back(n);
      if (!late.empty() && random() % 2 == 0) {
        arriving.push_back(late.back());
        late.pop_back();
      }
    }
    for (const std::uint32_t arrived : arriving) {
      reception.receive(at(1e-3 * arrived, arrived, now), kSender, now, feed);
      newest = std::max(newest, arrived);
    }
    if (newest == 0) continue;
    ASSERT_EQ(feed.sample(now, now).X_WFt.translation.x(), 1e-3 * newest);
  }
  EXPECT_GT(newest, 19000U);
}

/// Sends `bytes` again and again until the tracker has a valid pose; false after 20 s.
template <typename Send>
bool arrives(Tracker& tracker, const Send& send) {
  for (int i = 0; i < 2000; ++i) {
    send(static_cast<std::uint32_t>(i));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (tracker.sample(0.01 * i).valid) return true;
  }
  return false;
}

TEST(PoseListener, ReceivesDatagramsOnLoopback) {
  PoseListener tracker(kAnywhere, decode_pose_datagram);
  EXPECT_EQ(tracker.address().address, kLoopback);
  EXPECT_FALSE(tracker.sample(0.0).valid);
  UdpSocket sender(kAnywhere);
  const std::vector<std::uint8_t> noise(3000, 7);
  ASSERT_TRUE(arrives(tracker, [&](std::uint32_t i) {
    sender.send(tracker.address(), noise);
    sender.send(tracker.address(), encode_pose_datagram(at(0.25, i)));
  }));
  EXPECT_EQ(tracker.sample(30.0).X_WFt.translation.x(), 0.25);
  EXPECT_FALSE(tracker.end_time().has_value());
  std::this_thread::sleep_for(std::chrono::milliseconds(250));
  EXPECT_FALSE(tracker.sample(30.25).valid) << "lost in silence";
}

TEST(PoseListener, ReceivesOsc) {
  PoseListener tracker(kAnywhere, decode_osc_pose);
  UdpSocket sender(kAnywhere);
  ASSERT_TRUE(arrives(tracker, [&](std::uint32_t) {
    sender.send(tracker.address(), encode_osc_pose({Matrix3::Identity(), {0.5, 0, 0}}, false));
  }));
  EXPECT_EQ(tracker.sample(30.0).X_WFt.translation.x(), 0.5);
}

TEST(MakeTracker, NetworkTrackersListenAndRefuseAPortInUse) {
  const UdpSocket taken(kAnywhere);
  const std::string port = std::to_string(taken.local().port);
  for (const char* kind : {"udp:", "osc:"}) {
    try {
      (void)make_tracker(kind + port, "", {});
      ADD_FAILURE();
    } catch (const InputError& error) {
      const std::string line = error.what();
      EXPECT_NE(line.find(kind + port), std::string::npos) << line;
      EXPECT_NE(line.find("in use"), std::string::npos) << line;
    }
  }
  EXPECT_THROW((void)make_tracker("udp:203.0.113.1:7000", "", {}), InputError) << "not ours";
}

}  // namespace
}  // namespace softfinger
