#include "softfinger/tracking/natnet/natnet_session.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "softfinger/tracking/natnet/natnet_encoding.hpp"
#include "softfinger/tracking/up_axis.hpp"

namespace softfinger {
namespace {

constexpr std::uint64_t kTicks = 1'000'000;  // a second

TEST(NatNetClock, FindsTheOffsetUnderJitter) {
  std::mt19937 random(2);
  std::exponential_distribution<double> delay(1.0 / 0.004);
  NatNetClock clock;
  clock.reset(kTicks);
  EXPECT_FALSE(clock.local_time(5));
  // 20 parts in a million fast, and started so long ago that a double cannot count its ticks.
  const auto ticks_at = [](double t) {
    return (std::uint64_t{1} << 62) + static_cast<std::uint64_t>(t * (1.0 + 2e-5) * kTicks);
  };
  double worst = 0.0;
  double worst_last = 0.0;  // of the newest echo alone
  for (int i = 0; i < 400; ++i) {
    const double sent = 1000.0 + 0.5 * i;
    const double there = sent + 2e-4 + delay(random);
    const double back = there + 2e-4 + delay(random);
    clock.add(sent, back, ticks_at(there));
    if (i < 16) continue;
    worst = std::max(worst, std::abs(*clock.local_time(ticks_at(back)) - back));
    worst_last = std::max(worst_last, std::abs(0.5 * (sent + back) - there));
  }
  EXPECT_LT(worst, 0.0035);
  EXPECT_GT(worst_last, 3.0 * worst) << "choosing is what helps";
}

TEST(NatNetClock, BelievesAServerThatStartedAgain) {
  NatNetClock clock;
  clock.reset(kTicks);
  clock.add(10.0, 10.001, 500 * kTicks);
  EXPECT_NEAR(*clock.local_time(501 * kTicks), 11.0005, 1e-9);
  clock.add(11.0, 11.010, 3 * kTicks);
  EXPECT_NEAR(*clock.local_time(4 * kTicks), 12.005, 1e-9);
  clock.add(12.0, 14.0, 4 * kTicks);  // no use
  clock.add(12.0, 11.9, 4 * kTicks);
  EXPECT_NEAR(*clock.local_time(4 * kTicks), 12.005, 1e-9);
}

TEST(UpAxis, TurnsAYUpFrameIntoTheWorld) {
  const Pose X_KBody{exp_rotation({0.2, 0.3, -0.7}), {1.0, 2.0, 3.0}};
  const Pose X_WBody = world_from_tracker(UpAxis::kY, X_KBody);
  EXPECT_EQ(X_WBody.translation, Vector3(-3.0, -1.0, 2.0));
  // A turn about K's up axis is one about W's.
  const Pose about_up{exp_rotation({0.0, 0.4, 0.0}), Vector3::Zero()};
  const Vector3 turn = log_rotation(world_from_tracker(UpAxis::kY, about_up).rotation);
  EXPECT_LT((turn - Vector3(0.0, 0.0, 0.4)).norm(), 1e-12);
  for (const UpAxis up : {UpAxis::kY, UpAxis::kZ}) {
    const Pose back = tracker_from_world(up, world_from_tracker(up, X_KBody));
    EXPECT_LT((back.rotation - X_KBody.rotation).norm(), 1e-14);
    EXPECT_LT((back.translation - X_KBody.translation).norm(), 1e-14);
  }
  EXPECT_EQ(world_from_tracker(UpAxis::kZ, X_KBody).translation, X_KBody.translation);
}

/// A session, and its server's side.
class NatNetSessionTest : public testing::Test {
 protected:
  /// What the session sends now, by kind.
  std::vector<NatNetMessage> sent() {
    std::vector<NatNetMessage> kinds;
    session_.send_due(now_, [&](std::span<const std::uint8_t> datagram) {
      kinds.push_back(open_natnet(datagram)->message);
    });
    return kinds;
  }
  bool sends(NatNetMessage message) {
    const auto kinds = sent();
    return std::ranges::find(kinds, message) != kinds.end();
  }
  void receive(const NatNetDatagram& datagram) { session_.receive(datagram, now_); }
  void receive_server(NatNetVersion version, bool multicast = false) {
    receive(encode_natnet_server(
        {.name = "test", .version = version, .ticks_per_second = kTicks, .multicast = multicast}));
  }
  void receive_models(const std::vector<NatNetBody>& bodies) {
    receive(encode_natnet_models(bodies, {4, 1}, true));
  }
  NatNetDatagram frame(std::int32_t number, std::int32_t id, double x, bool tracked = true,
                       bool models_changed = false) const {
    const std::array<NatNetBodyPose, 1> bodies{NatNetBodyPose{
        .id = id, .X_KBody = {Matrix3::Identity(), {x, 0.0, 0.0}}, .tracked = tracked}};
    return encode_natnet_frame({.number = number,
                                .bodies = bodies,
                                .mid_exposure = static_cast<std::uint64_t>((now_ - 0.01) * kTicks),
                                .models_changed = models_changed},
                               {4, 1});
  }
  void connect() {
    receive_server({4, 1});
    receive_models({{5, "index"}});
  }
  TrackedPose pose() { return feed_.sample(now_ - 100.0, now_); }

  double now_ = 100.0;
  PoseFeed feed_;
  NatNetSession session_{
      TrackerSpec{.kind = TrackerKind::kNatnet, .body = "index", .up = UpAxis::kZ, .scale = 0.5},
      feed_};
};

TEST_F(NatNetSessionTest, AsksUntilItIsAnswered) {
  EXPECT_EQ(sent(), std::vector{NatNetMessage::kConnect});
  EXPECT_TRUE(sent().empty()) << "not all the time";
  now_ += 0.3;
  EXPECT_EQ(sent(), std::vector{NatNetMessage::kConnect});
  EXPECT_EQ(session_.stage(now_), NatNetStage::kNoAnswer);
  receive(frame(1, 5, 0.1));
  EXPECT_FALSE(pose().valid) << "of a server that is not known";
  receive_server({4, 1});
  EXPECT_EQ(session_.stage(now_), NatNetStage::kNoModels);
  const auto next = sent();
  for (const NatNetMessage message :
       {NatNetMessage::kRequestModels, NatNetMessage::kEchoRequest, NatNetMessage::kKeepAlive}) {
    EXPECT_NE(std::ranges::find(next, message), next.end());
  }
  receive_models({{4, "thumb"}});
  EXPECT_EQ(session_.stage(now_), NatNetStage::kNoSuchBody);
  receive_models({{4, "thumb"}, {5, "index"}});
  EXPECT_EQ(session_.stage(now_), NatNetStage::kNoFrames);
  receive(frame(2, 5, 0.1));
  EXPECT_EQ(session_.stage(now_), NatNetStage::kStreaming);
  EXPECT_TRUE(pose().valid);
  EXPECT_NEAR(pose().X_WFt.translation.x(), 0.05, 1e-7) << "scaled";
  now_ += 2.5;
  EXPECT_EQ(session_.stage(now_), NatNetStage::kNoAnswer);
  EXPECT_TRUE(sends(NatNetMessage::kConnect)) << "and asks again";
  receive(encode_natnet_echo({.stamp = static_cast<std::uint64_t>(now_ * 1e9), .ticks = 1}));
  now_ += 0.3;
  EXPECT_TRUE(sends(NatNetMessage::kConnect)) << "an echo may be another server's";
}

TEST_F(NatNetSessionTest, MulticastNeedsNoKeepAlive) {
  receive_server({4, 1}, true);
  EXPECT_TRUE(session_.multicast());
  EXPECT_FALSE(sends(NatNetMessage::kKeepAlive));
}

TEST_F(NatNetSessionTest, PoseAgeCountsFromMidExposure) {
  connect();
  // The server's clock is ours, as an echo without delay shows.
  receive(encode_natnet_echo({.stamp = static_cast<std::uint64_t>(now_ * 1e9),
                              .ticks = static_cast<std::uint64_t>(now_ * kTicks)}));
  receive(frame(1, 5, 0.1));
  EXPECT_NEAR(pose().time, now_ - 100.0 - 0.01, 1e-5);
}

TEST_F(NatNetSessionTest, TrackingThatTheServerLostIsHeldAndNotBelieved) {
  connect();
  receive(frame(1, 5, 0.1));
  ASSERT_TRUE(pose().valid);
  receive(frame(2, 5, 0.0, false));
  EXPECT_FALSE(pose().valid);
  EXPECT_NEAR(pose().X_WFt.translation.x(), 0.05, 1e-7);
  now_ += 0.01;
  receive(frame(3, 5, 0.15));
  EXPECT_TRUE(pose().valid);
  receive(frame(4, 6, 0.3));  // no word of the body
  EXPECT_FALSE(pose().valid);
  now_ += 0.01;
  receive(frame(6, 5, 0.2));
  receive(frame(5, 5, 0.18));
  EXPECT_NEAR(pose().X_WFt.translation.x(), 0.1, 1e-7) << "overtaken";
  receive(frame(7, 5, std::nan("")));
  EXPECT_NEAR(pose().X_WFt.translation.x(), 0.1, 1e-7);
}

TEST_F(NatNetSessionTest, ModelsAreAskedForAgainWhenTheyChange) {
  connect();
  receive(frame(1, 5, 0.1));
  (void)sent();
  now_ += 1.5;
  EXPECT_FALSE(sends(NatNetMessage::kRequestModels));
  receive(frame(2, 5, 0.1, true, true));
  EXPECT_TRUE(sends(NatNetMessage::kRequestModels));
  receive_models({{9, "index"}});
  EXPECT_FALSE(sends(NatNetMessage::kRequestModels));
  now_ += 0.05;
  receive(frame(3, 9, 0.4));
  EXPECT_TRUE(pose().valid);
  EXPECT_NEAR(pose().X_WFt.translation.x(), 0.2, 1e-7) << "the body with its new number";
}

TEST_F(NatNetSessionTest, ANewerServerIsAskedForAVersionThatIsKnown) {
  receive_server({4, 4});
  EXPECT_EQ(session_.stage(now_), NatNetStage::kOtherVersion);
  EXPECT_TRUE(sends(NatNetMessage::kRequest));
  receive(encode_natnet_response(1));
  EXPECT_EQ(session_.stage(now_), NatNetStage::kOtherVersion);
  receive(encode_natnet_response(0));
  EXPECT_EQ(session_.stage(now_), NatNetStage::kNoModels);
  receive(encode_natnet_models(std::vector<NatNetBody>{{5, "index"}}, {4, 2}, true));
  receive(frame(1, 5, 0.1));
  EXPECT_TRUE(pose().valid);
}

TEST_F(NatNetSessionTest, OldServersAndOthersStreamsAreLeftAlone) {
  receive_server({4, 4}, true);
  EXPECT_FALSE(sends(NatNetMessage::kRequest)) << "others listen to the same stream";
  receive_server({2, 9});
  EXPECT_FALSE(sends(NatNetMessage::kRequest));
  EXPECT_EQ(session_.stage(now_), NatNetStage::kOtherVersion);
}

TEST_F(NatNetSessionTest, NoiseNeverMakesAPoseThatIsNone) {
  connect();
  std::mt19937 random(9);
  for (int i = 1; i < 20000; ++i) {
    now_ += 0.001;
    NatNetDatagram noisy = frame(i, 5, 0.1);
    if (i % 3 == 0)
      noisy = encode_natnet_models(std::vector<NatNetBody>{{5, "index"}}, {4, 1}, true);
    if (i % 50 == 0) noisy = encode_natnet_server({.version = {4, 1}, .ticks_per_second = kTicks});
    for (int change = 0; change < 2; ++change) {
      noisy[random() % noisy.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
    }
    receive(noisy);
    const TrackedPose sampled = pose();
    ASSERT_TRUE(sampled.X_WFt.translation.allFinite());
    ASSERT_LE(sampled.X_WFt.translation.norm(), 174.0);
    ASSERT_NEAR(sampled.X_WFt.rotation.determinant(), 1.0, 1e-9);
    ASSERT_LE(sampled.time, now_ - 100.0 + 1e-9);
  }
}

}  // namespace
}  // namespace softfinger
