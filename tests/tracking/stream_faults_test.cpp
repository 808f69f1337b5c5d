// What goes wrong between a sender of poses and the loop, in simulated time: datagrams lost,
// doubled, overtaken and cut, and clocks that step or run wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "softfinger/tracking/conditioning/interpolated_tracker.hpp"
#include "softfinger/tracking/natnet/natnet_encoding.hpp"
#include "softfinger/tracking/natnet/natnet_session.hpp"
#include "softfinger/tracking/stream/osc_pose.hpp"
#include "softfinger/tracking/stream/pose_datagram.hpp"
#include "softfinger/tracking/stream/pose_listener.hpp"

namespace softfinger {
namespace {

using Datagram = std::vector<std::uint8_t>;

constexpr double kRate = 120.0;       // Hz
constexpr double kExposure = 0.004;   // s before a pose is sent it is true
constexpr double kRunStart = 1000.0;  // s of the monotonic clock, start of the run
constexpr std::uint64_t kServerTicks = 10'000'000;

/// Where the finger is: at most 0.25 m/s. Its y is the time itself, in m/s.
Pose hand_pose(double time) {
  return {exp_rotation({0.0, 0.3 * std::sin(time), 0.0}),
          {0.05 * std::sin(5.0 * time), 1e-2 * time, 0.0}};
}
double time_of(const Pose& X_WFt) { return 1e2 * X_WFt.translation.y(); }

/// A sender of poses and what listens to it.
class Stream {
 public:
  virtual ~Stream() = default;
  /// A pose, true when the sender's clock showed `clock` (s).
  [[nodiscard]] virtual Datagram say(std::uint32_t number, const Pose& X_WFt,
                                     double clock) const = 0;
  virtual void hear(const Datagram& datagram, double now) = 0;
  /// What the listener asks and the sender answers, its clock showing `clock`.
  virtual std::vector<Datagram> answers(double, double) { return {}; }

  PoseFeed feed;
};

class UdpStream final : public Stream {
 public:
  Datagram say(std::uint32_t number, const Pose& X_WFt, double clock) const override {
    const PoseDatagram bytes =
        encode_pose_datagram({.X_WFt = X_WFt, .valid = true, .sequence = number, .time = clock});
    return {bytes.begin(), bytes.end()};
  }
  void hear(const Datagram& datagram, double now) override {
    const auto message = decode_pose_datagram(datagram);
    if (message) reception_.receive(*message, {kLoopback, 5000}, now, feed);
  }

 private:
  PoseReception reception_;
};

class NatNetStream final : public Stream {
 public:
  Datagram say(std::uint32_t number, const Pose& X_WFt, double clock) const override {
    const std::array<NatNetBodyPose, 1> bodies{
        NatNetBodyPose{.id = 5, .X_KBody = X_WFt, .tracked = true}};
    return encode_natnet_frame({.number = static_cast<std::int32_t>(number),
                                .bodies = bodies,
                                .mid_exposure = ticks(clock),
                                .with_all_sections = true},
                               {4, 1});
  }
  void hear(const Datagram& datagram, double now) override { session_.receive(datagram, now); }
  std::vector<Datagram> answers(double now, double clock) override {
    std::vector<Datagram> answers;
    session_.send_due(now, [&](std::span<const std::uint8_t> asked) {
      const auto packet = open_natnet(asked);
      ASSERT_TRUE(packet);
      if (packet->message == NatNetMessage::kConnect) {
        answers.push_back(encode_natnet_server({.name = "test",
                                                .version = {4, 1},
                                                .ticks_per_second = kServerTicks,
                                                .multicast = false}));
      } else if (packet->message == NatNetMessage::kRequestModels) {
        answers.push_back(
            encode_natnet_models(std::vector<NatNetBody>{{5, "index"}}, {4, 1}, true));
      } else if (packet->message == NatNetMessage::kEchoRequest) {
        answers.push_back(encode_natnet_echo(
            {.stamp = static_cast<std::uint64_t>(now * 1e9), .ticks = ticks(clock)}));
      }
    });
    return answers;
  }

 private:
  static std::uint64_t ticks(double clock) {
    return (std::uint64_t{1} << 60) + static_cast<std::uint64_t>((clock + 1e5) * kServerTicks);
  }
  NatNetSession session_{
      TrackerSpec{.kind = TrackerKind::kNatnet, .body = "index", .up = UpAxis::kZ}, feed};
};

/// What becomes of datagrams, as probabilities, and of the sender's clock.
struct StreamTrouble {
  double loss = 0.0;
  double duplication = 0.0;
  double reordering = 0.0;
  std::function<bool(std::uint32_t)> glitch = [](std::uint32_t) { return false; };  ///< 1 m aside
  std::function<double(double)> clock = [](double time) { return time; };
};

struct Sampled {
  double time = 0.0;   ///< s, of the run
  TrackedPose pose;    ///< the newest
  TrackedPose played;  ///< between two, as steps take it
  [[nodiscard]] double said_age() const { return time - pose.time; }
  [[nodiscard]] double true_age() const { return time - time_of(pose.X_WFt); }
};

/// The pose that was sampled last, as a tracker.
class LastSampled final : public Tracker {
 public:
  explicit LastSampled(const TrackedPose& last) : last_(last) {}
  TrackedPose sample(double) override { return last_; }
  [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }

 private:
  const TrackedPose& last_;
};

/// Poses as a loop of 1 kHz samples them.
std::vector<Sampled> run(Stream& stream, const StreamTrouble& trouble, double duration) {
  std::mt19937_64 random(17);
  const auto chance = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::multimap<double, Datagram> on_its_way;
  const auto post = [&](const Datagram& datagram, double now) {
    if (chance() < trouble.loss) return;
    const int copies = chance() < trouble.duplication ? 2 : 1;
    for (int i = 0; i < copies; ++i) {
      // Held up for as long as three others take.
      const double held = chance() < trouble.reordering ? 3.0 / kRate * chance() : 0.0;
      on_its_way.emplace(now + 0.001 + 0.002 * chance() + held, datagram);
    }
  };
  TrackedPose newest;
  InterpolatedTracker tracker(std::make_unique<LastSampled>(newest));
  std::vector<Sampled> sampled;
  std::uint32_t number = 0;
  for (int step = 0; step < static_cast<int>(duration * 1e3); ++step) {
    const double time = 1e-3 * step;
    const double now = kRunStart + time;
    if (time * kRate >= number) {
      const double captured = time - kExposure;
      Pose X_WFt = hand_pose(captured);
      if (trouble.glitch(++number)) X_WFt.translation.x() += 1.0;
      post(stream.say(number, X_WFt, trouble.clock(captured)), now);
    }
    while (!on_its_way.empty() && on_its_way.begin()->first <= now) {
      stream.hear(on_its_way.begin()->second, now);
      on_its_way.erase(on_its_way.begin());
    }
    for (const Datagram& answer : stream.answers(now, trouble.clock(time))) post(answer, now);
    newest = stream.feed.sample(time, now);
    sampled.push_back({time, newest, tracker.sample(time)});
  }
  return sampled;
}

class StreamFaults : public testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<Stream> stream() const {
    if (GetParam() == std::string("udp")) return std::make_unique<UdpStream>();
    return std::make_unique<NatNetStream>();
  }
  /// How well ages are known, s. Of a sender that is never asked, the shortest delay is taken for
  /// none.
  static double knowledge() { return GetParam() == std::string("udp") ? 0.0065 : 0.0025; }
  /// From `from` on tracking is never lost, no pose is older than the one before, and none is said
  /// to be of the future or, by more than `error` (s), of another time than it is.
  static void expect_sane(const std::vector<Sampled>& sampled, double from, double error) {
    double newest = -1.0;
    int checked = 0;
    for (const Sampled& one : sampled) {
      if (one.time < from) continue;
      ++checked;
      ASSERT_TRUE(one.pose.valid) << "at " << one.time;
      ASSERT_GE(time_of(one.pose.X_WFt), newest - 1e-6) << "at " << one.time;
      newest = time_of(one.pose.X_WFt);
      ASSERT_LE((hand_pose(newest).translation - one.pose.X_WFt.translation).norm(), 1e-6)
          << "a pose that nobody sent";
      ASSERT_TRUE(one.played.valid) << "at " << one.time;
      ASSERT_LE(time_of(one.played.X_WFt), newest + 1e-6) << "at " << one.time;
      ASSERT_GE(one.said_age(), -1e-9) << "at " << one.time;
      ASSERT_NEAR(one.said_age(), one.true_age(), error) << "at " << one.time;
    }
    EXPECT_GT(checked, 1000);
  }
};

INSTANTIATE_TEST_SUITE_P(Network, StreamFaults, testing::Values("udp", "natnet"),
                         [](const auto& name) { return std::string(name.param); });

TEST_P(StreamFaults, DuplicatedReorderedAndThirtyPercentLost) {
  const auto listened = stream();
  const auto sampled = run(*listened, {.loss = 0.3, .duplication = 0.2, .reordering = 0.3}, 60.0);
  expect_sane(sampled, 1.0, knowledge() + 0.0025);
  std::vector<double> ages, played_ages;
  double farthest = 0.0;
  for (const Sampled& one : sampled) {
    if (one.time < 1.0) continue;
    ages.push_back(one.true_age());
    played_ages.push_back(one.time - time_of(one.played.X_WFt));
    const Vector3 there = hand_pose(one.time).translation;
    farthest = std::max(farthest, std::abs(there.x() - one.pose.X_WFt.translation.x()));
  }
  std::ranges::sort(ages);
  EXPECT_LT(ages[ages.size() * 99 / 100], 0.045) << "s, where all that is sent comes it is 0.016";
  EXPECT_LT(ages.back(), 0.12);
  std::ranges::sort(played_ages);
  std::printf(
      "%s: of the poses that steps take half are less than %.0f ms old, 99 %% %.0f, all %.0f\n",
      GetParam(), 1e3 * played_ages[played_ages.size() / 2],
      1e3 * played_ages[played_ages.size() * 99 / 100], 1e3 * played_ages.back());
  EXPECT_LT(played_ages[played_ages.size() * 99 / 100], 0.06);
  EXPECT_LT(played_ages.back(), 0.12);
  EXPECT_LT(farthest, 0.25 * 0.12) << "m behind a finger of 0.25 m/s";
}

TEST_P(StreamFaults, GlitchesAreNoPoses) {
  const auto listened = stream();
  const auto sampled =
      run(*listened, {.loss = 0.3, .glitch = [](std::uint32_t number) { return number % 3 == 0; }},
          60.0);
  expect_sane(sampled, 1.0, knowledge() + 0.0025);
}

TEST_P(StreamFaults, ABodyThatStaysWhereItJumpedToIsBelieved) {
  const auto listened = stream();
  const auto sampled =
      run(*listened, {.glitch = [](std::uint32_t number) { return number > 240; }}, 3.0);
  for (const Sampled& one : sampled) {
    if (one.time < 0.1) continue;
    ASSERT_TRUE(one.pose.valid) << "at " << one.time;
    if (one.time > 2.0 && one.time < 2.12) continue;
    const bool jumped = one.pose.X_WFt.translation.x() > 0.9;
    ASSERT_EQ(jumped, one.time > 2.1) << "at " << one.time;
  }
}

TEST_P(StreamFaults, WithoutTroubleThePoseIsOneIntervalOld) {
  const auto listened = stream();
  const auto sampled = run(*listened, {}, 10.0);
  expect_sane(sampled, 1.0, knowledge());
  for (const Sampled& one : sampled) {
    if (one.time < 1.0) continue;
    ASSERT_LT(one.true_age(), kExposure + 0.003 + 1.0 / kRate + 0.0015);
  }
}

TEST_P(StreamFaults, TheSendersClockSteps) {
  for (const double shift : {3600.0, -3600.0, 0.1, -0.1}) {
    const auto listened = stream();
    const auto sampled =
        run(*listened, {.clock = [shift](double time) { return time < 3.0 ? time : time + shift; }},
            20.0);
    // Until clocks are compared anew a pose may be taken for as much older as a small step is.
    expect_sane(sampled, 1.0, 0.12);
    const std::vector<Sampled> later(sampled.end() - 4000, sampled.end());
    expect_sane(later, 0.0, knowledge());
  }
}

TEST_P(StreamFaults, TheSendersClockRunsWrong) {
  for (const double rate : {1.01, 0.99}) {
    const auto listened = stream();
    const auto sampled =
        run(*listened, {.loss = 0.1, .clock = [rate](double time) { return rate * time; }}, 30.0);
    // 1 % of the 10 s over which the least delay is looked for.
    expect_sane(sampled, 1.0, 0.105);
  }
}

TEST_P(StreamFaults, SilenceIsLostTrackingAndEndsWithIt) {
  const auto listened = stream();
  // The first half arrives, then nothing, then a sender that counts from 1 again.
  const auto before = run(*listened, {}, 2.0);
  ASSERT_TRUE(before.back().pose.valid);
  EXPECT_TRUE(listened->feed.sample(2.15, kRunStart + 2.15).valid);
  EXPECT_FALSE(listened->feed.sample(2.21, kRunStart + 2.21).valid);
  const Datagram again = listened->say(1, hand_pose(3.0), 3.0);
  listened->hear(again, kRunStart + 3.0);
  const TrackedPose pose = listened->feed.sample(3.0, kRunStart + 3.0);
  EXPECT_TRUE(pose.valid);
  EXPECT_NEAR(time_of(pose.X_WFt), 3.0, 1e-5);
}

TEST_P(StreamFaults, HalfADatagramChangesNothing) {
  const auto listened = stream();
  const auto before = run(*listened, {}, 2.0);
  const double now = kRunStart + 2.0;
  const TrackedPose last = listened->feed.sample(2.0, now);
  const Datagram whole = listened->say(5000, hand_pose(2.5), 2.0);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    Datagram half(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    listened->hear(half, now);
    if (size >= 4 && GetParam() == std::string("natnet")) {
      // And where the header knows of it.
      half[2] = static_cast<std::uint8_t>((size - 4) & 0xff);
      half[3] = static_cast<std::uint8_t>((size - 4) >> 8);
      listened->hear(half, now);
    }
    ASSERT_EQ(listened->feed.sample(2.0, now).X_WFt.translation, last.X_WFt.translation)
        << size << " of " << whole.size() << " bytes";
  }
  listened->hear(whole, now);
  EXPECT_NEAR(time_of(listened->feed.sample(2.0, now).X_WFt), 2.5, 1e-4);
}

TEST(OscFaults, HalfADatagramIsRefused) {
  for (const bool float64 : {false, true}) {
    const auto whole = encode_osc_pose(hand_pose(1.0), float64);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      ASSERT_FALSE(decode_osc_pose(std::span(whole).first(size)))
          << size << " of " << whole.size() << " bytes";
    }
    EXPECT_TRUE(decode_osc_pose(whole));
  }
}

}  // namespace
}  // namespace softfinger
