// What goes wrong between a loop and its servos, in simulated time: where the device is meanwhile
// and after it, and that nothing sent is more than a device may do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "../support/lever_platform.hpp"
#include "simulated_line.hpp"

namespace softfinger {
namespace {

constexpr double kAcceleration = 20'000.0 * deg;  // rad/s^2

Configuration lever_pose(double pitch_deg, double roll_deg, double travel_mm) {
  Configuration q(3);
  q << pitch_deg * deg, roll_deg * deg, travel_mm * mm;
  return q;
}

/// A calm exploration: at most 120 degrees a second in a joint.
Configuration exploration(double time) {
  const double phase = 2.0 * std::numbers::pi * 0.4 * time;
  return lever_pose(12.0 * std::sin(phase), 8.0 * std::cos(0.7 * phase), 3.0 * std::sin(phase));
}

class LineFaults : public testing::TestWithParam<const char*> {
 protected:
  LineFaults() { line_.wanted = exploration; }

  JointAngles joints_at(const Configuration& q) const {
    JointAngles joints;
    EXPECT_TRUE(device_->inverse_kinematics(q, joints));
    return joints;
  }
  Board board(const Configuration& q) const { return board_at(*device_, q); }
  bool is_maestro() const { return GetParam() == std::string("maestro"); }

  /// A step of the wire for each of two commands.
  double rounding() const {
    const ServoSettings& servo = device_->settings().transport->servos.front();
    return 2.0 * servo.step / std::abs(servo.per_radian) + 1e-9;
  }
  double most_in(double seconds) const {
    return device_->joint_limits().max_rate * seconds + rounding();
  }
  static double apart(const JointAngles& a, const JointAngles& b) {
    return (a - b).cwiseAbs().maxCoeff();
  }

  /// Limits of angle and of speed, of each command after the one before it (of those after `from`);
  /// `missed`: commands that one servo may not have had before it.
  void expect_within_limits(double from = 0.0, int missed = 0) const {
    const JointLimits& limits = device_->joint_limits();
    const SimulatedLine::Sent* before = nullptr;
    ASSERT_FALSE(line_.sent().empty());
    for (const auto& sent : line_.sent()) {
      EXPECT_GE((sent.joints - limits.min).minCoeff(), -1e-9) << sent.time;
      EXPECT_GE((limits.max - sent.joints).minCoeff(), -1e-9) << sent.time;
      if (before != nullptr && before->time >= from) {
        EXPECT_LE(apart(sent.joints, before->joints),
                  most_in(sent.time - before->time + missed * line_.period()))
            << "at " << sent.time << " s";
      }
      before = &sent;
    }
  }
  /// No joint gets faster than it may, where every command arrived.
  void expect_gentle(double from, double to) const {
    const auto& sent = line_.sent();
    int compared = 0;
    for (std::size_t k = 2; k < sent.size(); ++k) {
      if (sent[k - 2].time < from || sent[k].time > to) continue;
      ++compared;
      const double dt = sent[k].time - sent[k - 1].time;
      const double dt_before = sent[k - 1].time - sent[k - 2].time;
      const auto speed = (sent[k].joints - sent[k - 1].joints).array() / dt;
      const auto before = (sent[k - 1].joints - sent[k - 2].joints).array() / dt_before;
      const double gained = (speed.abs() - before.abs()).maxCoeff();
      EXPECT_LE(gained, kAcceleration * dt + 4.0 * rounding() / dt) << "at " << sent[k].time;
    }
    EXPECT_GT(compared, 5) << from << " to " << to << " s";
  }
  const SimulatedLine::Sent* first_after(double time) const {
    const auto& sent = line_.sent();
    const auto found = std::ranges::find_if(sent, [&](const auto& one) { return one.time > time; });
    return found == sent.end() ? nullptr : &*found;
  }
  /// The servos are where the loop wants them, but for what a servo and a tick are behind.
  void expect_following() const {
    const double behind = 120.0 * deg * (2.0 * line_.period() + 2.0 / 60.0);
    EXPECT_LE(apart(line_.standing(), joints_at(exploration(line_.time()))), behind)
        << "at " << line_.time() << " s";
  }
  void expect_following_at(double time) {
    line_.at(time, [this] { expect_following(); });
  }
  void expect_retracted() const {
    EXPECT_LE(apart(line_.standing(), joints_at(device_->retracted())), 0.2 * deg);
  }

  std::shared_ptr<const Device> device_ = lever_platform(
      {.rate = 60.0, .reversed_servo = true, .acceleration = kAcceleration, .kind = GetParam()});
  SimulatedLine line_{device_};
};

INSTANTIATE_TEST_SUITE_P(Buses, LineFaults, testing::Values("maestro", "dynamixel", "feetech"),
                         [](const auto& name) { return std::string(name.param); });

TEST_P(LineFaults, NoneFollowsAndRetracts) {
  Board home = board(device_->home());
  line_.plug_in(home);
  for (const double time : {1.0, 2.0, 3.0}) expect_following_at(time);
  line_.run(3.0);
  expect_within_limits();
  expect_gentle(0.0, 10.0);
  expect_retracted();
  EXPECT_GE(line_.sent().size(), 175u);
  EXPECT_NEAR(line_.sent().back().time, line_.sent()[line_.sent().size() - 2].time, 0.02);
}

TEST_P(LineFaults, CablePulledAndBack) {
  Board home = board(device_->home());
  line_.plug_in(home);
  line_.at(1.0, [&] { line_.unplug(); });
  line_.at(1.5, [&] { EXPECT_EQ(line_.channel().state, DeviceState::kDisconnected); });
  JointAngles left;
  line_.at(1.8, [&] {
    left = line_.standing();
    line_.plug_in(home);
  });
  expect_following_at(4.0);
  line_.run(4.5);
  const auto* first = first_after(1.8);
  ASSERT_NE(first, nullptr);
  EXPECT_LT(first->time, 2.8) << "attempts are made every 0.3 s";
  EXPECT_LE(apart(first->joints, left), most_in(line_.period())) << "no jump on return";
  EXPECT_GT(apart(first->joints, joints_at(exploration(first->time))), 5.0 * deg)
      << "or this test shows nothing";
  expect_within_limits();
  expect_gentle(0.0, 1.0);
  expect_gentle(1.8, 10.0);
  expect_retracted();
}

TEST_P(LineFaults, ServosThatStandElsewhereOnReturn) {
  Board first = board(device_->home());
  Board second = board(lever_pose(-9.0, 6.0, -4.0));
  line_.plug_in(first);
  line_.at(1.0, [&] { line_.unplug(); });
  JointAngles elsewhere;
  line_.at(1.5, [&] {
    line_.plug_in(second);
    elsewhere = line_.standing();
  });
  expect_following_at(3.5);
  line_.run(4.0);
  const auto* back = first_after(1.5);
  ASSERT_NE(back, nullptr);
  EXPECT_LE(apart(back->joints, elsewhere), most_in(line_.period()));
  expect_within_limits(1.5);
  expect_gentle(1.5, 10.0);
  expect_retracted();
}

TEST_P(LineFaults, CablePulledForGood) {
  Board home = board(device_->home());
  line_.plug_in(home);
  line_.at(1.0, [&] { line_.unplug(); });
  line_.run(5.0);
  EXPECT_LT(line_.time(), 5.5) << "a device that is gone is not waited for";
  expect_within_limits();
}

TEST_P(LineFaults, CablePulledShortlyBeforeTheEnd) {
  Board home = board(device_->home());
  line_.plug_in(home);
  line_.at(1.0, [&] { line_.unplug(); });
  line_.run(2.0);
  EXPECT_LT(line_.time(), 4.5) << "it is waited for, but not for ever";
  expect_within_limits();
}

TEST_P(LineFaults, APortThatBlinksAtTheEndIsRetractedAllTheSame) {
  Board home = board(device_->home());
  line_.plug_in(home);
  line_.at(1.9, [&] { line_.unplug(); });
  line_.at(3.4, [&] { line_.plug_in(home); });
  line_.run(2.0);
  expect_within_limits();
  expect_retracted();
}

TEST_P(LineFaults, BoardResetInMidFrame) {
  Board home = board(device_->home());
  line_.plug_in(home);
  // A later byte of the frame each time.
  std::size_t cut = 1;
  bool due = false;
  line_.to_board = [&](SimulatedLine::Bytes& bytes) {
    if (!due || bytes.size() < 12) return;
    due = false;
    const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(cut);
    home.bus->receive({bytes.begin(), middle});
    home.reset();
    bytes.erase(bytes.begin(), middle);
  };
  // A table bus takes its time to find out and to open anew.
  const double every = is_maestro() ? 0.2 : 2.0;
  const std::size_t stride = is_maestro() ? 1 : 5;
  double time = 1.0;
  for (; cut < 12; cut += stride, time += every) {
    line_.at(time, [&, now = cut] {
      cut = now;
      due = true;
    });
    expect_following_at(time + 0.95 * every);
  }
  cut = 1;
  line_.run(time);
  EXPECT_FALSE(due);
  expect_within_limits();
  expect_retracted();
}

TEST_P(LineFaults, BoardWithoutPowerBehindALineThatStays) {
  Board home = board(device_->home());
  line_.plug_in(home);
  bool dark = false;
  line_.to_board = [&](SimulatedLine::Bytes& bytes) {
    if (dark) bytes.clear();
  };
  line_.at(1.0, [&] {
    dark = true;
    home.reset();
  });
  JointAngles left;
  line_.at(2.0, [&] {
    dark = false;
    left = line_.standing();
  });
  expect_following_at(4.5);
  line_.run(5.0);
  const auto* first = first_after(2.0);
  ASSERT_NE(first, nullptr);
  // 0.1 s and a tick of this motion, before the silence is noticed, and how far servos were behind.
  EXPECT_LE(apart(first->joints, left), 120.0 * deg * (0.1 + line_.period() + 2.0 / 60.0));
  EXPECT_GT(apart(first->joints, joints_at(exploration(first->time))), 5.0 * deg)
      << "or this test shows nothing";
  expect_within_limits(2.0);
  expect_retracted();
}

TEST_P(LineFaults, HalfAPacketToTheBoard) {
  Board home = board(device_->home());
  line_.plug_in(home);
  std::mt19937_64 random(11);
  bool bad = false;
  bool cut_before = false;
  line_.to_board = [&](SimulatedLine::Bytes& bytes) {
    // A Maestro's bytes have no checksum: what remains of two packets in a row could be a command.
    const bool may_join = is_maestro() && cut_before;
    cut_before = bad && !may_join && random() % 10 < 3;
    if (!cut_before) return;
    const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(random() % bytes.size());
    random() % 2 == 0 ? bytes.erase(bytes.begin(), middle) : bytes.erase(middle, bytes.end());
  };
  line_.at(0.5, [&] { bad = true; });
  line_.at(3.0, [&] { bad = false; });
  if (is_maestro()) {
    line_.at(3.0, [&] { EXPECT_EQ(line_.channel().complaints[2] & kBadLine, kBadLine); });
    line_.at(4.0, [&] { EXPECT_EQ(line_.channel().complaints[2], 0); });
  } else {
    expect_following_at(4.0);
  }
  line_.run(4.5);
  EXPECT_EQ(line_.channel().times_lost, 0u) << "30 % of packets are no lost port";
  EXPECT_EQ(line_.channel().stop.is_stopped(), is_maestro()) << "it says that bytes were lost";
  // Of a packet cut in half some of a Maestro's servos have their target.
  expect_within_limits(0.0, is_maestro() ? 1 : 0);
  expect_retracted();
}

TEST_P(LineFaults, HalfAPacketFromTheBoard) {
  Board home = board(device_->home());
  line_.plug_in(home);
  std::mt19937_64 random(5);
  SimulatedLine::Bytes late;
  bool bad = false;
  line_.from_board = [&](SimulatedLine::Bytes& bytes) {
    bytes.insert(bytes.begin(), late.begin(), late.end());
    late.clear();
    if (!bad || random() % 10 >= 3) return;
    const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2);
    if (random() % 2 == 0) late.assign(middle, bytes.end());  // the rest comes later, or never
    bytes.erase(middle, bytes.end());
  };
  line_.at(0.5, [&] { bad = true; });
  int known = 0;
  for (double time = 0.5; time < 3.0; time += 0.01) {
    line_.at(time, [&] {
      const auto said = line_.reported();
      if (!said) return;
      ++known;
      EXPECT_LE(apart(*said, line_.standing()), 120.0 * deg * 0.1) << "at " << line_.time();
    });
  }
  line_.at(3.0, [&] { bad = false; });
  expect_following_at(3.5);
  line_.run(4.0);
  EXPECT_GT(known, 50);
  EXPECT_EQ(line_.channel().times_lost, 0u);
  expect_within_limits();
  expect_retracted();
}

// As a USB adapter does that waits 16 ms for more to send.
TEST_P(LineFaults, AnswersThatComeSeveralAtATime) {
  const auto fast = lever_platform({.rate = 200.0, .reversed_servo = true, .kind = GetParam()});
  Board home = board_at(*fast, fast->home());
  SimulatedLine line(fast);
  line.wanted = exploration;
  line.plug_in(home);
  SimulatedLine::Bytes waiting;
  int answers = 0;
  line.from_board = [&](SimulatedLine::Bytes& bytes) {
    if (bytes.empty() || line.time() < 1.0) return;
    waiting.insert(waiting.end(), bytes.begin(), bytes.end());
    bytes.clear();
    if (++answers % 5 == 0) bytes.swap(waiting);
  };
  int known = 0;
  for (double time = 1.1; time < 3.0; time += 0.01) {
    line.at(time, [&] {
      known += line.reported() ? 1 : 0;
      const double behind = 120.0 * deg * (2.0 * line.period() + 2.0 / 60.0);
      EXPECT_LE(apart(line.standing(), joints_at(exploration(line.time()))), behind)
          << "at " << line.time() << " s";
    });
  }
  line.run(3.0);
  EXPECT_GT(answers, 100);
  EXPECT_GT(known, 20);
  EXPECT_EQ(line.channel().times_lost, 0u);
}

TEST_P(LineFaults, ALoopThatHangs) {
  Board home = board(device_->home());
  line_.plug_in(home);
  line_.wanted = [](double time) -> std::optional<Configuration> {
    if (time > 1.0 && time < 2.0) return std::nullopt;
    return exploration(time);
  };
  line_.at(1.08, [&] { EXPECT_EQ(line_.channel().state, DeviceState::kReady); });
  line_.at(1.08, [&] { expect_within_limits(); });
  line_.at(1.14, [&] { EXPECT_EQ(line_.channel().state, DeviceState::kRetracting); });
  line_.at(1.6, [&] { expect_retracted(); });
  expect_following_at(2.6);
  line_.run(3.0);
  EXPECT_EQ(line_.channel().times_stalled, 1u);
  expect_within_limits();
  expect_gentle(0.0, 10.0);
  expect_retracted();
  int retracting = 0;
  for (std::size_t k = 1; k < line_.sent().size(); ++k) {
    const auto &before = line_.sent()[k - 1], &sent = line_.sent()[k];
    if (before.time < 1.12 || sent.time > 1.25) continue;
    ++retracting;
    EXPECT_LE(sent.time - before.time, 1.1 * line_.period()) << "nobody has to be waited for";
  }
  EXPECT_GT(retracting, 3);
}

}  // namespace
}  // namespace softfinger
