// What comes back from a device, held against what it was told; in simulated time.
#include "softfinger/actuation/supervision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>

#include "lever_line.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"

namespace softfinger {
namespace {

constexpr double kError = 10.0 * deg;  // of the lever platform

JointAngles all(double angle) { return JointAngles::Constant(3, angle); }

TEST(Supervision, AServoThatLagsByLessThanItsTimeFollows) {
  const auto device = lever_platform();
  Supervision supervision(*device);
  for (int k = 0; k < 600; ++k) {
    const double time = k / 60.0;
    const auto at = [](double t) { return all(0.8 * std::sin(4.0 * t)); };
    supervision.sent(time, at(time));
    EXPECT_EQ(supervision.seen(time, at(time - 0.9 * Supervision::kFollowTime)), 0U) << time;
  }
}

TEST(Supervision, AServoThatStandsStillIsNamedOnceItsCommandsHaveLeftIt) {
  const auto device = lever_platform();
  Supervision supervision(*device);
  for (int k = 0; k < 240; ++k) {
    const double time = k / 60.0;
    const double travel = std::min(time, 1.0) * 2.0 * kError;  // leaves kError after 0.5 s
    JointAngles standing = all(travel);
    standing[1] = 0.0;
    supervision.sent(time, all(travel));
    const std::uint32_t astray = supervision.seen(time, standing);
    if (time < 0.5) {
      EXPECT_EQ(astray, 0U) << time;
    } else if (time > 0.5 + 1.3 * Supervision::kFollowTime) {
      EXPECT_EQ(astray, 2U) << time;
    }
  }
}

TEST(Supervision, NamesNobodyWhereNothingWasSentOrNoErrorIsTooLarge) {
  const auto device = lever_platform();
  Supervision nothing_sent(*device);
  DeviceSettings tolerant = lever_settings({});
  tolerant.following_error = 0.0;
  const Device no_limit(tolerant, std::make_unique<const LeverPlatform>(tolerant, false),
                        std::make_unique<const LevelPlane>());
  Supervision unlimited(no_limit);
  Supervision of_others(*device);
  for (int k = 0; k < 240; ++k) {
    const double time = k / 60.0;
    unlimited.sent(time, all(0.0));
    of_others.sent(time, JointAngles::Zero(2));
    EXPECT_EQ(nothing_sent.seen(time, all(1.0)), 0U);
    EXPECT_EQ(unlimited.seen(time, all(1.0)), 0U);
    EXPECT_EQ(of_others.seen(time, all(1.0)), 0U) << "three joints were not told of two";
  }
  // From the first report on that is of what was sent.
  for (int k = 240; k < 360; ++k) of_others.sent(k / 60.0, all(0.0));
  std::uint32_t astray = 0;
  for (int k = 0; k < 10; ++k) astray = of_others.seen(6.0, all(1.0));
  EXPECT_EQ(astray, 7U);
}

TEST(Supervision, StartsAnewWithAPortThatIsOpenedAgain) {
  const auto device = lever_platform();
  Supervision supervision(*device);
  const auto stand = [&](double from, double until) {
    for (double time = from; time < until; time += 1.0 / 60.0) supervision.sent(time, all(0.0));
  };
  stand(0.0, 2.0);
  std::uint32_t astray = 0;
  int reports = 0;
  for (; astray == 0 && reports < 20; ++reports) astray = supervision.seen(2.0, all(1.0));
  ASSERT_EQ(astray, 7U);
  ASSERT_GT(reports, 1) << "one report is none";
  supervision.restart();
  EXPECT_EQ(supervision.seen(2.1, all(1.0)), 0U) << "nothing was sent yet";
  stand(3.0, 5.0);
  for (int k = 1; k < reports; ++k) EXPECT_EQ(supervision.seen(5.0, all(1.0)), 0U) << k;
  EXPECT_EQ(supervision.seen(5.0, all(1.0)), 7U);
}

TEST(Supervision, OneWrongReportNamesNobody) {
  const auto device = lever_platform();
  Supervision supervision(*device);
  int wrong = 0;
  for (int k = 0; k < 240; ++k) {
    const double time = k / 60.0;
    supervision.sent(time, all(0.0));
    const bool noise = k % 7 < 2;
    wrong += noise ? 1 : 0;
    EXPECT_EQ(supervision.seen(time, all(noise ? 1.0 : 0.0)), 0U) << time;
  }
  EXPECT_GT(wrong, 50);
}

TEST(Supervision, AfterARestartNobodyIsNamedBeforeTheyHadTheirTime) {
  const auto device = lever_platform();
  Supervision supervision(*device);
  const auto named_from = [&](double from) {
    for (int k = 0; k < 120; ++k) {
      const double time = from + k / 60.0;
      supervision.sent(time, all(0.0));
      if (supervision.seen(time, all(1.0)) == 7U) return time - from;
    }
    return -1.0;
  };
  EXPECT_GE(named_from(0.0), Supervision::kFollowTime);
  supervision.restart();
  EXPECT_GE(named_from(10.0), Supervision::kFollowTime);
}

TEST(Supervision, PressingIsTooLongWithoutAPause) {
  const auto device = lever_platform({.press_time = 2.0});
  const auto first_too_long = [&](double pause) {
    Supervision supervision(*device);
    for (int k = 0; k < 600; ++k) {
      const double time = k / 100.0;
      const bool lets_go = time >= 1.5 && time < 1.5 + pause;
      if (supervision.pressed_too_long(time, !lets_go)) return time;
    }
    return 1e9;
  };
  EXPECT_NEAR(first_too_long(0.0), 2.0, 0.02);
  EXPECT_NEAR(first_too_long(0.8 * Supervision::kPause), 2.0, 0.02) << "a twitch is no pause";
  EXPECT_NEAR(first_too_long(1.2 * Supervision::kPause), 1.5 + 1.2 * Supervision::kPause + 2.0,
              0.02);
}

class SupervisedLine : public LeverLine, public testing::WithParamInterface<const char*> {
 protected:
  explicit SupervisedLine(double press_time = 0.0, bool limp_at_end = false)
      : LeverLine({.rate = 60.0,
                   .kind = GetParam(),
                   .press_time = press_time,
                   .limp_at_end = limp_at_end}) {
    line_.plug_in(board_);
  }

  Board board_ = board_at(*device_, device_->home());
};

std::string name_of(const testing::TestParamInfo<const char*>& kind) { return kind.param; }

class BlockedServo : public SupervisedLine {
 protected:
  ServoTableEmulator& servos_ = dynamic_cast<ServoTableEmulator&>(*board_.bus);
};
INSTANTIATE_TEST_SUITE_P(Buses, BlockedServo, testing::Values("dynamixel", "feetech"), name_of);

TEST_P(BlockedServo, IsNamedTheOthersRetractAndNothingStartsBeforeItMoves) {
  line_.at(1.0, [this] { servos_.block(2); });
  Configuration away_from_it = pressing_;
  away_from_it[2] -= 6.0 * mm;
  line_.wanted = [=, this](double time) { return time < 1.5 ? pressing_ : away_from_it; };
  line_.at(4.0, [this] {
    ++looks_;
    const StopLatch& stop = line_.channel().stop;
    EXPECT_TRUE(stop.is_stopped());
    EXPECT_EQ(stop.cause(), StopCause::kServo);
    EXPECT_EQ(line_.channel().astray.load(), 4U);
    EXPECT_LE(away(0, device_->retracted()), 0.3 * deg);
    EXPECT_LE(away(1, device_->retracted()), 0.3 * deg);
    line_.ask_release(stop.newest());
  });
  line_.at(5.0, [this] {
    ++looks_;
    EXPECT_TRUE(line_.channel().stop.is_stopped());
    EXPECT_EQ(line_.channel().stop.refusal(), ReleaseRefusal::kServoFault);
    servos_.block(2, false);
  });
  line_.at(7.0, [this] {
    ++looks_;
    EXPECT_EQ(line_.channel().astray.load(), 0U);
    line_.ask_release(line_.channel().stop.newest());
  });
  line_.at(9.0, [=, this] {
    ++looks_;
    EXPECT_FALSE(line_.channel().stop.is_stopped());
    EXPECT_LE(away(away_from_it), 0.3 * deg);
  });
  line_.run(9.5);
  EXPECT_EQ(looks_, 4);
}

class LongPress : public SupervisedLine {
 protected:
  LongPress() : SupervisedLine(2.0) {}
};
INSTANTIATE_TEST_SUITE_P(Buses, LongPress, testing::Values("maestro", "dynamixel", "feetech"),
                         name_of);

TEST_P(LongPress, RetractsUntilItIsReleased) {
  line_.touching = true;
  line_.at(1.9, [this] {
    ++looks_;
    EXPECT_FALSE(line_.channel().stop.is_stopped());
    EXPECT_LE(away(pressing_), 0.3 * deg);
  });
  line_.at(4.0, [this] {
    ++looks_;
    EXPECT_TRUE(line_.channel().stop.is_stopped());
    EXPECT_EQ(line_.channel().stop.cause(), StopCause::kPressed);
    EXPECT_LE(away(device_->retracted()), 0.3 * deg);
    line_.ask_release(line_.channel().stop.newest());
  });
  line_.at(5.5, [this] {
    ++looks_;
    EXPECT_FALSE(line_.channel().stop.is_stopped()) << "its time began anew";
    EXPECT_LE(away(pressing_), 0.3 * deg);
  });
  line_.run(5.6);
  EXPECT_EQ(looks_, 3);
}

class LimpAtEnd : public SupervisedLine {
 protected:
  LimpAtEnd() : SupervisedLine(0.0, true) {}
};
INSTANTIATE_TEST_SUITE_P(Buses, LimpAtEnd, testing::Values("dynamixel", "feetech"), name_of);

TEST_P(LimpAtEnd, ServosLetGoOnceTheyAreRetracted) {
  auto& servos = dynamic_cast<ServoTableEmulator&>(*board_.bus);
  line_.at(2.0, [&] {
    ++looks_;
    for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(servos.torque(i));
  });
  line_.run(2.5);
  EXPECT_EQ(looks_, 1);
  EXPECT_LE(away(device_->retracted()), 0.3 * deg);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_FALSE(servos.torque(i));
}

TEST_P(LimpAtEnd, AlsoWhereOneIsStuck) {
  auto& servos = dynamic_cast<ServoTableEmulator&>(*board_.bus);
  line_.at(2.0, [&] {
    ++looks_;
    servos.block(1);
  });
  line_.run(2.2);
  EXPECT_EQ(looks_, 1);
  EXPECT_GT(away(1, device_->retracted()), kError) << "or nothing is stuck";
  for (std::size_t i = 0; i < 3; ++i) EXPECT_FALSE(servos.torque(i)) << "it may press";
}

TEST_P(LimpAtEnd, DoesNotWaitForAPortThatGoesAwayMeanwhile) {
  for (const double after : {0.35, 0.5, 0.65, 0.8}) {
    SimulatedLine line(device_);
    Board board = board_at(*device_, device_->home());
    line.plug_in(board);
    line.wanted = [this](double) { return pressing_; };
    line.at(2.0 + after, [&] {
      ++looks_;
      line.unplug();
    });
    line.run(2.0);
    EXPECT_LT(line.time(), 2.0 + 6.0) << after;
  }
  EXPECT_EQ(looks_, 4);
}

TEST_P(LimpAtEnd, ThoseThatWereToldNothingKeepWhatTheyHave) {
  auto& servos = dynamic_cast<ServoTableEmulator&>(*board_.bus);
  line_.wanted = [](double) -> std::optional<Configuration> { return std::nullopt; };
  line_.run(2.0);
  EXPECT_TRUE(line_.sent().empty());
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(servos.torque(i));
}

class WithoutPulsesAtEnd : public LimpAtEnd {};
INSTANTIATE_TEST_SUITE_P(Buses, WithoutPulsesAtEnd, testing::Values("maestro"), name_of);

TEST_P(WithoutPulsesAtEnd, ThereAreNoneOnceItIsRetracted) {
  line_.at(2.0, [this] {
    ++looks_;
    EXPECT_NE(board_.target(0), 0);
  });
  line_.run(2.5);
  EXPECT_EQ(looks_, 1);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(board_.target(i), 0);
  EXPECT_LE(away(device_->retracted()), 0.3 * deg);
}

}  // namespace
}  // namespace softfinger
