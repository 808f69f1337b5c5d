// Stop and release at the line that leads the servos, in simulated time: how soon, and whatever
// else goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "lever_line.hpp"

namespace softfinger {
namespace {

/// First retracting command after a stop, s: what the docs promise of the line's part.
constexpr double kSoon = 0.005;

class StoppedLine : public LeverLine,
                    public testing::WithParamInterface<std::tuple<const char*, double>> {
 protected:
  StoppedLine() : LeverLine({.rate = std::get<1>(GetParam()), .kind = std::get<0>(GetParam())}) {
    line_.plug_in(board_);
  }
  [[nodiscard]] double away_from_retracted(const JointAngles& joints) const {
    return (joints - joints_at(device_->retracted())).cwiseAbs().maxCoeff();
  }
  /// The first command after `time` that is nearer to the retracted pose than what came before.
  [[nodiscard]] double first_retracting_after(double time) const {
    const SimulatedLine::Sent* before = nullptr;
    for (const auto& sent : line_.sent()) {
      if (before != nullptr && sent.time >= time &&
          away_from_retracted(sent.joints) < away_from_retracted(before->joints) - 1e-4) {
        return sent.time;
      }
      before = &sent;
    }
    return 1e9;
  }
  void expect_retracted_at(double time) {
    line_.at(time, [this] {
      ++looks_;
      EXPECT_LE(away(device_->retracted()), 0.3 * deg) << line_.time();
    });
  }
  void expect_pressing_at(double time) {
    line_.at(time, [this] {
      ++looks_;
      EXPECT_LE(away(pressing_), 0.3 * deg) << line_.time();
    });
  }

  Board board_ = board_at(*device_, device_->home());
};

INSTANTIATE_TEST_SUITE_P(Buses, StoppedLine,
                         testing::Combine(testing::Values("maestro", "dynamixel", "feetech"),
                                          testing::Values(5.0, 60.0)),
                         [](const auto& name) {
                           return std::string(std::get<0>(name.param)) + "At" +
                                  std::to_string(static_cast<int>(std::get<1>(name.param))) + "Hz";
                         });

TEST_P(StoppedLine, TheFirstRetractingCommandIsOnTheWireAtOnce) {
  double stopped = 0.0;
  StopLatch::Number number = 0;
  expect_pressing_at(3.0);
  line_.at(3.013, [&] {
    stopped = line_.time();
    number = line_.stop();
  });
  line_.at(3.013 + 2.0 * kSoon, [&] { EXPECT_EQ(line_.channel().stop.confirmed(), number); });
  expect_retracted_at(6.0);
  line_.run(8.0);
  EXPECT_LE(first_retracting_after(stopped), stopped + kSoon);
  EXPECT_EQ(looks_, 2);
  EXPECT_TRUE(line_.channel().stop.is_stopped());
}

TEST_P(StoppedLine, ALoopThatSaysNothingIsStoppedAsSoon) {
  line_.wanted = [this](double time) {
    return time < 3.0 ? std::optional(pressing_) : std::nullopt;
  };
  double stopped = 0.0;
  line_.at(3.02, [&] {
    stopped = line_.time();
    line_.stop();
  });
  expect_retracted_at(6.0);
  line_.run(7.0);
  EXPECT_LE(first_retracting_after(stopped), stopped + kSoon);
  EXPECT_EQ(looks_, 1);
}

TEST_P(StoppedLine, ReleasesOnlyRetractedAndOnlyTheStopThatIsNamed) {
  StopLatch::Number first = 0;
  StopLatch::Number second = 0;
  line_.at(3.0, [&] { first = line_.stop(); });
  line_.at(3.0 + 0.4 * line_.period(), [&] { line_.ask_release(first); });
  line_.at(5.0, [&] {
    EXPECT_EQ(line_.channel().stop.refusal(), ReleaseRefusal::kRetracting);
    EXPECT_EQ(line_.channel().stop.refusals(), 1U);
    second = line_.stop();
    line_.ask_release(first);
  });
  expect_retracted_at(6.0);
  line_.at(6.0, [&] { line_.ask_release(second); });
  expect_pressing_at(10.0);
  line_.run(11.0);
  EXPECT_EQ(line_.channel().stop.released(), second);
  EXPECT_EQ(line_.channel().stop.refusals(), 1U);
  EXPECT_EQ(looks_, 2);
}

// That it was retracted once is no reason.
TEST_P(StoppedLine, IsNotReleasedWhereItWasRetractedBeforeAndPressesAgain) {
  line_.at(2.0, [&] { line_.stop(); });
  line_.at(6.0, [&] { line_.ask_release(line_.channel().stop.newest()); });
  expect_pressing_at(10.0);
  line_.at(10.0, [&] { line_.stop(); });
  line_.at(10.0 + 0.4 * line_.period(), [&] { line_.ask_release(line_.channel().stop.newest()); });
  line_.at(12.0, [&] {
    EXPECT_TRUE(line_.channel().stop.is_stopped());
    EXPECT_EQ(line_.channel().stop.refusal(), ReleaseRefusal::kRetracting);
  });
  line_.run(12.5);
  EXPECT_EQ(looks_, 1);
}

TEST_P(StoppedLine, IsNotReleasedWhileTheLoopSaysNothing) {
  line_.wanted = [this](double time) {
    return time < 3.0 || time > 8.0 ? std::optional(pressing_) : std::nullopt;
  };
  StopLatch::Number number = 0;
  line_.at(2.9, [&] { number = line_.stop(); });
  line_.at(6.0, [&] { line_.ask_release(number); });
  line_.at(7.0, [&] {
    EXPECT_EQ(line_.channel().stop.refusal(), ReleaseRefusal::kNoCommands);
    EXPECT_TRUE(line_.channel().stop.is_stopped());
  });
  // Commands again are no release.
  expect_retracted_at(11.0);
  line_.at(11.0, [&] { line_.ask_release(number); });
  expect_pressing_at(14.0);
  line_.run(15.0);
  EXPECT_EQ(looks_, 2);
}

// After two ticks without a command, long before the loop counts as stalled.
TEST_P(StoppedLine, IsReleasedByALoopThatIsHardlyLateAndNotByOneThatHasMissedTwoTicks) {
  for (const double ticks : {1.2, 1.4, 2.2, 2.9}) {
    SimulatedLine line(device_);
    Board board = board_at(*device_, device_->home());
    line.plug_in(board);
    double last = 0.0;
    line.wanted = [&](double time) -> std::optional<Configuration> {
      if (time > 5.0) return std::nullopt;
      last = time;
      return pressing_;
    };
    line.at(2.0, [&] { line.stop(); });
    line.at(5.0 + 1e-3 * line.period(), [&] {
      line.at(last + ticks * line.period(),
              [&] { line.ask_release(line.channel().stop.newest()); });
    });
    line.run(6.0 + 5.0 * line.period());
    EXPECT_EQ(line.channel().stop.is_stopped(), ticks > 2.0) << ticks;
    EXPECT_EQ(line.channel().stop.refusal(),
              ticks > 2.0 ? ReleaseRefusal::kNoCommands : ReleaseRefusal::kNone);
  }
}

TEST_P(StoppedLine, APortThatIsGoneIsNotReleasedAndComesBackStopped) {
  StopLatch::Number number = 0;
  Board back = board_at(*device_, pressing_);
  line_.at(3.0, [&] { line_.unplug(); });
  line_.at(3.5, [&] { number = line_.stop(); });
  line_.at(4.0, [&] {
    EXPECT_NE(line_.channel().stop.confirmed(), number) << "nobody knows";
    line_.ask_release(number);
  });
  line_.at(5.0, [&] {
    EXPECT_EQ(line_.channel().stop.refusal(), ReleaseRefusal::kPortClosed);
    line_.plug_in(back);
  });
  expect_retracted_at(10.0);
  line_.at(10.0, [&] { EXPECT_EQ(line_.channel().stop.confirmed(), number); });
  line_.run(11.0);
  EXPECT_EQ(looks_, 1);
}

TEST_P(StoppedLine, StoppedBeforeAnythingWasWantedItRetracts) {
  line_.wanted = nullptr;
  line_.at(0.5, [&] { line_.stop(); });
  expect_retracted_at(5.0);
  line_.run(6.0);
  EXPECT_EQ(looks_, 1);
}

TEST_P(StoppedLine, IsNotReleasedWhileTheBoardSaysNothingOrTheLoopIsLate) {
  line_.at(2.0, [&] { line_.stop(); });
  line_.at(5.0, [&] {
    ++looks_;
    line_.from_board = [](SimulatedLine::Bytes& bytes) { bytes.clear(); };
  });
  // Longer than a board may be silent, and not long enough to be lost.
  const double silent = 5.0 + std::max(0.1, 3.0 * line_.period()) + 3.0 * line_.period();
  line_.at(silent, [&] { line_.ask_release(line_.channel().stop.newest()); });
  line_.at(silent + 2.0 * line_.period(), [&] {
    ++looks_;
    EXPECT_TRUE(line_.channel().stop.is_stopped());
    EXPECT_EQ(line_.channel().stop.refusal(), ReleaseRefusal::kServoFault);
    line_.from_board = nullptr;
  });
  line_.run(silent + 4.0);
  EXPECT_EQ(looks_, 2);
  EXPECT_TRUE(line_.channel().stop.is_stopped());
}

}  // namespace
}  // namespace softfinger
