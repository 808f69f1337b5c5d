#include <gtest/gtest.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <thread>
#include <vector>

#include "../support/lever_platform.hpp"
#include "../support/maestro_terminal.hpp"
#include "simulated_line.hpp"
#include "softfinger/actuation/servo_line.hpp"
#include "softfinger/motors/servo_bus.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

/// A Maestro without pulses, as it is after power comes: nobody knows where its servos stand.
class ServoLineEdges : public testing::Test {
 protected:
  ServoLineEdges() { board_.reset(); }

  static Configuration advanced(double travel) {
    Configuration q = Configuration::Zero(3);
    q[2] = travel;
    return q;
  }
  [[nodiscard]] JointAngles joints_of(const Configuration& q) const {
    JointAngles joints;
    EXPECT_TRUE(device_->inverse_kinematics(q, joints));
    return joints;
  }
  /// How far the first command is from q, in the joint that is furthest; rad.
  [[nodiscard]] double first_from(const Configuration& q) const {
    EXPECT_FALSE(line_.sent().empty());
    if (line_.sent().empty()) return std::numeric_limits<double>::infinity();
    return (line_.sent().front().joints - joints_of(q)).cwiseAbs().maxCoeff();
  }
  /// What a joint may move in a tick, and the rounding of two commands.
  [[nodiscard]] double tick_travel() const { return 400.0 * deg * line_.period() + 0.2 * deg; }
  /// A stop leads it away, though no loop ever wanted anything.
  void run_stopped() {
    line_.plug_in(board_);
    line_.at(0.5, [this] { line_.stop(); });
    line_.run(2.0);
  }

  std::shared_ptr<const Device> device_ = lever_platform({.rate = 100.0});
  Board board_ = board_at(*device_, device_->home());
  SimulatedLine line_{device_};
};

TEST_F(ServoLineEdges, ServosOfUnknownPositionGetTimeToComeToTheFirstPose) {
  line_.plug_in(board_);
  line_.wanted = [](double) { return advanced(5.0 * mm); };
  line_.run(2.0);
  EXPECT_LT(first_from(device_->home()), 0.1 * deg);
  double stood = 0.0;
  for (const SimulatedLine::Sent& sent : line_.sent()) {
    if ((sent.joints - line_.sent().front().joints).cwiseAbs().maxCoeff() > 0.1 * deg) break;
    stood = sent.time - line_.sent().front().time;
  }
  // All that a joint can have to go, at its rate.
  EXPECT_GE(stood, 110.0 / 400.0 - 2.0 * line_.period());
  EXPECT_LE(stood, 110.0 / 400.0 + 2.0 * line_.period());
}

TEST_F(ServoLineEdges, APortIsLookedForEvery300Milliseconds) {
  line_.wanted = [](double) { return advanced(5.0 * mm); };
  line_.at(1.0, [this] { line_.plug_in(board_); });  // it was absent at the start
  line_.at(2.0, [this] {
    line_.unplug();
    line_.plug_in(board_);
  });
  line_.run(4.0);
  ASSERT_FALSE(line_.sent().empty());
  EXPECT_GE(line_.sent().front().time, 1.15) << "it was looked for at 0.9 s";
  EXPECT_LE(line_.sent().front().time, 1.4);
  EXPECT_EQ(line_.channel().times_connected.load(), 2U);
  EXPECT_EQ(line_.channel().times_lost.load(), 1U);
  double longest = 0.0;
  for (std::size_t i = 1; i < line_.sent().size(); ++i) {
    longest = std::max(longest, line_.sent()[i].time - line_.sent()[i - 1].time);
  }
  EXPECT_GE(longest, 0.3) << "not at once where it has just failed";
  EXPECT_LE(longest, 0.45);
}

TEST_F(ServoLineEdges, ALineThatTakesOverGoesOnFromWhatWasSentBefore) {
  const Configuration before = advanced(12.0 * mm);
  line_.was_sent_before(before);
  run_stopped();
  EXPECT_LE(first_from(before), tick_travel());
  EXPECT_GT(first_from(device_->home()), tick_travel());
  EXPECT_LT((line_.sent().back().joints - joints_of(device_->retracted())).cwiseAbs().maxCoeff(),
            0.1 * deg);
}

TEST_F(ServoLineEdges, ALineThatTakesOverWaitsForAPortThatMayBeBackInAMoment) {
  line_.was_sent_before(advanced(12.0 * mm));
  line_.run(0.5);
  EXPECT_NEAR(line_.time(), 3.0, 2.0 * line_.period());
}

TEST_F(ServoLineEdges, WhatServosSayAsTheyAreFoundIsToldBeforeTheyAreLed) {
  Board standing = board_at(*device_, device_->home());
  line_.plug_in(standing);
  bool looked = false;
  line_.at(0.5, [&] {
    looked = true;
    const auto joints = line_.reported();
    ASSERT_TRUE(joints);
    EXPECT_LE((*joints - joints_of(device_->home())).cwiseAbs().maxCoeff(), 0.1 * deg);
  });
  line_.run(1.0);
  EXPECT_TRUE(looked);
  EXPECT_TRUE(line_.sent().empty());
}

TEST_F(ServoLineEdges, TheFirstLineStartsAtHome) {
  run_stopped();
  EXPECT_LE(first_from(device_->home()), tick_travel());
}

// As that of a program that is killed: nobody says that it ends.
TEST_F(ServoLineEdges, ALoopWhoseProcessEndsHasTheDeviceRetractAndTheLineEnd) {
  for (const bool silent : {false, true}) {
    SimulatedLine line(device_);
    Board board = board_at(*device_, device_->home());
    line.plug_in(board);
    std::array<int, 2> ends{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
    line.loop = ends[0];
    bool gone = false;
    line.wanted = [&](double) -> std::optional<Configuration> {
      if (gone || silent) return std::nullopt;
      return advanced(12.0 * mm);
    };
    line.at(2.0, [&] {
      ::close(ends[1]);
      gone = true;
    });
    line.run(60.0);
    ::close(ends[0]);
    EXPECT_TRUE(gone);
    EXPECT_LT(line.time(), 10.0) << "it does not wait to be told";
    EXPECT_EQ(line.sent().empty(), silent);
    if (silent) continue;
    EXPECT_LT((line.sent().back().joints - joints_of(device_->retracted())).cwiseAbs().maxCoeff(),
              0.1 * deg);
  }
}

// What was not heard of one board is not held against the one that is there when the port is back.
TEST_F(ServoLineEdges, ABoardThatWasSilentAndComesBackWithoutPulsesIsLed) {
  SimulatedLine line(device_);
  Board board = board_at(*device_, device_->home());
  line.plug_in(board);
  line.wanted = [](double time) { return advanced(time < 4.0 ? 12.0 * mm : 5.0 * mm); };
  line.at(2.0, [&] { line.from_board = [](SimulatedLine::Bytes& bytes) { bytes.clear(); }; });
  line.at(2.5, [&] {
    line.unplug();
    board.reset();
    line.from_board = nullptr;
  });
  line.at(3.0, [&] { line.plug_in(board); });
  bool looked = false;
  line.at(6.0, [&] {
    looked = true;
    EXPECT_LE((line.standing() - joints_of(advanced(5.0 * mm))).cwiseAbs().maxCoeff(), 0.3 * deg);
  });
  line.run(6.5);
  EXPECT_TRUE(looked);
}

TEST_F(ServoLineEdges, APortThatGoesAwayBeforeAnythingWasSentIsNotWaitedForAtTheEnd) {
  SimulatedLine line(device_);
  Board board = board_at(*device_, device_->home());
  line.plug_in(board);
  line.at(0.5, [&] { line.unplug(); });
  line.run(1.0);
  EXPECT_TRUE(line.sent().empty());
  EXPECT_LT(line.time(), 2.0);
}

// As while tracking is lost for a moment, which the loop alone knows.
TEST_F(ServoLineEdges, WhileItFollowsItsStateIsTheLoops) {
  for (const DeviceState state : {DeviceState::kReady, DeviceState::kRendering,
                                  DeviceState::kHolding, DeviceState::kHoming}) {
    SimulatedLine line(device_);
    Board board = board_at(*device_, device_->home());
    line.plug_in(board);
    line.wanted = [](double) { return advanced(5.0 * mm); };
    line.spoil = [state](LineChannel::Wanted& wanted) {
      wanted.state = state;
      wanted.seal = wanted.seal_of_this();
    };
    bool looked = false;
    line.at(2.0, [&] {
      looked = true;
      EXPECT_EQ(line.channel().state.load(), state);
    });
    line.run(2.5);
    EXPECT_TRUE(looked);
  }
}

TEST_F(ServoLineEdges, LeavesWhatItSentToTheLineThatTakesItsPlace) {
  line_.plug_in(board_);
  line_.wanted = [](double) { return advanced(5.0 * mm); };
  bool looked = false;
  line_.at(2.0, [&] {
    looked = true;
    const LineChannel::Sent sent = line_.said_to_be_sent();
    EXPECT_TRUE(sent.is_whole());
    ASSERT_EQ(sent.q.size(), 3);
    EXPECT_NEAR(sent.q[2], 5.0 * mm, 1e-9);
  });
  line_.run(2.5);
  EXPECT_TRUE(looked);
}

TEST_F(ServoLineEdges, TellsHowFarServosThatAnswerAreBehind) {
  Board standing = board_at(*device_, device_->home());
  line_.plug_in(standing);
  line_.wanted = [](double time) { return advanced(5.0 * mm * std::sin(6.0 * time)); };
  int told = 0;
  for (int k = 0; k < 100; ++k) {
    line_.at(1.0 + 0.01 * k, [&] {
      const auto delivery = line_.delivered();
      if (delivery && std::isfinite(delivery->servo)) ++told;
    });
  }
  line_.run(2.5);
  EXPECT_GT(told, 20);
}

// By the clock that loop and line share.
TEST_F(ServoLineEdges, TellsHowOldACommandWasWhenItWasSent) {
  constexpr double kAge = 100.0;  // s, more than any test takes
  line_.plug_in(board_);
  line_.wanted = [](double) { return advanced(5.0 * mm); };
  line_.spoil = [](LineChannel::Wanted& wanted) {
    wanted.formed = monotonic_time() - kAge;
    wanted.seal = wanted.seal_of_this();
  };
  line_.run(2.0);
  const auto delivery = line_.delivered();
  ASSERT_TRUE(delivery);
  EXPECT_GE(delivery->send, kAge);
  EXPECT_LE(delivery->send, 2.0 * kAge);
}

TEST_F(ServoLineEdges, WhatIsNoPoseIsNotTakenOver) {
  for (const Configuration& no_pose : {Configuration(Configuration::Zero(2)),
                                       advanced(std::numeric_limits<double>::quiet_NaN())}) {
    SimulatedLine line(device_);
    Board board = board_at(*device_, device_->home());
    board.reset();
    line.was_sent_before(no_pose);
    line.plug_in(board);
    line.at(0.5, [&] { line.stop(); });
    line.run(2.0);
    ASSERT_FALSE(line.sent().empty());
    EXPECT_LE((line.sent().front().joints - joints_of(device_->home())).cwiseAbs().maxCoeff(),
              tick_travel());
  }
}

// While the line lives, whoever comes next gets the port once it has served.
TEST(ServoLineEdgesOfPorts, ALineThatHasServedHasLetGoOfItsPort) {
  const auto device = lever_platform();
  const TransportSettings& transport = *device->settings().transport;
  std::vector<EmulatedServo> servos;
  for (const ServoSettings& servo : transport.servos) servos.push_back({.channel = servo.channel});
  const MaestroTerminal terminal(servos);
  LineChannel channel(device->home());
  const int wake = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  ServoLine line(device, {.port = terminal.port()}, channel, wake);
  ASSERT_EQ(line.open(), "");
  EXPECT_NE(make_servo_bus(transport)->open(terminal.port()), "");
  channel.ending = true;
  // A thread of its own, since it takes the priority of those that serve ports.
  std::thread([&line] { line.serve(); }).join();
  EXPECT_FALSE(channel.connected.load());
  EXPECT_EQ(channel.state.load(), DeviceState::kStopped);
  EXPECT_EQ(make_servo_bus(transport)->open(terminal.port()), "");
  ::close(wake);
}

}  // namespace
}  // namespace softfinger
