// What the servos do that are left when one cannot be led any more, and where servos are led that
// stand where no configuration has them; in simulated time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "lever_line.hpp"
#include "softfinger/motors/servo_map.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"

namespace softfinger {
namespace {

/// From a fault to the other servos retracted, s: what the docs promise.
constexpr double kFree = 4.0;

class LostServo : public LeverLine,
                  public testing::WithParamInterface<std::tuple<const char*, int, bool>> {
 protected:
  LostServo() : LeverLine({.rate = 60.0, .kind = std::get<0>(GetParam())}) {
    line_.plug_in(board_);
  }

  void lose() {
    if (std::get<2>(GetParam())) {
      servos_.trip(lost_);
    } else {
      servos_.cut_off(lost_);
    }
  }
  void expect_others_retracted_at(double time) {
    line_.at(time, [this] {
      ++looks_;
      for (Eigen::Index joint = 0; joint < 3; ++joint) {
        if (joint == Eigen::Index(lost_)) continue;
        EXPECT_LE(away(joint, device_->retracted()), 0.3 * deg) << joint << " " << line_.time();
      }
    });
  }

  std::size_t lost_ = static_cast<std::size_t>(std::get<1>(GetParam()));
  Board board_ = board_at(*device_, device_->home());
  ServoTableEmulator& servos_ = dynamic_cast<ServoTableEmulator&>(*board_.bus);
};

INSTANTIATE_TEST_SUITE_P(Buses, LostServo,
                         testing::Combine(testing::Values("dynamixel", "feetech"),
                                          testing::Values(0, 1, 2), testing::Bool()),
                         [](const auto& name) {
                           return std::string(std::get<0>(name.param)) + "Servo" +
                                  std::to_string(std::get<1>(name.param)) +
                                  (std::get<2>(name.param) ? "Trips" : "IsCutOff");
                         });

TEST_P(LostServo, TheOthersRetractAndStaySo) {
  line_.at(2.0, [this] {
    ++looks_;
    EXPECT_LE(away(pressing_), 0.3 * deg);
    lose();
  });
  expect_others_retracted_at(2.0 + kFree);
  line_.at(2.0 + kFree, [this] {
    const StopLatch& stop = line_.channel().stop;
    EXPECT_TRUE(stop.is_stopped());
    EXPECT_EQ(stop.cause(), StopCause::kServo);
    EXPECT_EQ(stop.confirmed(), stop.newest());
    EXPECT_EQ(line_.channel().faults.load().any(), 1U << lost_);
    line_.ask_release(stop.newest());
  });
  expect_others_retracted_at(2.0 + kFree + 4.0);
  line_.at(2.0 + kFree + 4.0, [this] {
    // What tripped is back, since release looks for it; what is cut off is not.
    if (!std::get<2>(GetParam())) {
      EXPECT_EQ(line_.channel().stop.refusal(), ReleaseRefusal::kServoFault);
      EXPECT_TRUE(line_.channel().stop.is_stopped());
    }
  });
  line_.run(11.0);
  EXPECT_EQ(looks_, 3);
  for (Eigen::Index joint = 0; joint < 3; ++joint) {
    if (joint == Eigen::Index(lost_)) continue;
    EXPECT_LE(away(joint, device_->retracted()), 0.3 * deg) << "after the end";
  }
}

TEST_P(LostServo, ItGoesOnOnlyWhenTheServoIsBackAndSomebodyReleases) {
  line_.at(2.0, [this] { lose(); });
  line_.at(7.0, [this] { servos_.cut_off(lost_, false); });
  expect_others_retracted_at(9.0);
  // The first finds the servo again, the second the device retracted with it.
  for (const double time : {9.0, 13.0}) {
    line_.at(time, [this] { line_.ask_release(line_.channel().stop.newest()); });
  }
  line_.at(12.9,
           [this] { EXPECT_EQ(line_.channel().stop.refusal(), ReleaseRefusal::kRetracting); });
  line_.at(17.0, [this] {
    ++looks_;
    EXPECT_FALSE(line_.channel().stop.is_stopped());
    EXPECT_EQ(line_.channel().faults.load().any(), 0U);
    EXPECT_LE(away(pressing_), 0.3 * deg);
  });
  line_.run(18.0);
  EXPECT_EQ(looks_, 2);
}

/// Servos that are cut off, at several rates of ticks.
class SilentServo : public LeverLine,
                    public testing::WithParamInterface<std::tuple<const char*, double>> {
 protected:
  SilentServo() : LeverLine({.rate = std::get<1>(GetParam()), .kind = std::get<0>(GetParam())}) {
    line_.plug_in(board_);
  }
  Board board_ = board_at(*device_, device_->home());
};
INSTANTIATE_TEST_SUITE_P(Rates, SilentServo,
                         testing::Combine(testing::Values("dynamixel", "feetech"),
                                          testing::Values(20.0, 60.0, 200.0)),
                         [](const auto& name) {
                           return std::string(std::get<0>(name.param)) + "At" +
                                  std::to_string(static_cast<int>(std::get<1>(name.param))) + "Hz";
                         });

TEST_P(SilentServo, CountsAsLostAfterTwentyTicksAndHalfASecond) {
  auto& servos = dynamic_cast<ServoTableEmulator&>(*board_.bus);
  line_.at(2.0, [&] { servos.cut_off(2); });
  const double patience = std::max(20.0 * line_.period(), 0.5);
  line_.at(2.0 + patience - 2.0 * line_.period(), [this] {
    ++looks_;
    EXPECT_EQ(line_.channel().faults.load().any(), 0U);
  });
  line_.at(2.0 + patience + 6.0 * line_.period(), [this] {
    ++looks_;
    EXPECT_EQ(line_.channel().faults.load().any(), 4U);
  });
  line_.run(6.0);
  EXPECT_EQ(looks_, 2);
}

TEST_P(LostServo, AReleaseThatFindsNobodyIsRefused) {
  line_.at(2.0, [this] { lose(); });
  line_.at(7.0, [this] {
    ++looks_;
    ASSERT_TRUE(line_.channel().stop.is_stopped());
    // Nobody answers who is looked for.
    line_.from_board = [](SimulatedLine::Bytes& bytes) { bytes.clear(); };
    line_.ask_release(line_.channel().stop.newest());
  });
  line_.at(9.0, [this] {
    ++looks_;
    EXPECT_TRUE(line_.channel().stop.is_stopped());
    EXPECT_EQ(line_.channel().stop.refusals(), 1U);
    EXPECT_EQ(line_.channel().stop.refusal(), ReleaseRefusal::kServoFault);
    line_.from_board = nullptr;
  });
  line_.run(14.0);
  EXPECT_EQ(looks_, 2);
  EXPECT_TRUE(line_.channel().stop.is_stopped());
  EXPECT_LE(away(lost_ == 0 ? 1 : 0, device_->retracted()), 0.3 * deg);
}

class BrownOut : public LeverLine, public testing::WithParamInterface<const char*> {
 protected:
  BrownOut() : LeverLine({.rate = 60.0, .kind = GetParam()}) { line_.plug_in(board_); }
  Board board_ = board_at(*device_, device_->home());
};
INSTANTIATE_TEST_SUITE_P(Buses, BrownOut, testing::Values("dynamixel", "feetech"),
                         [](const auto& name) { return std::string(name.param); });

// Power that fails again each time the servos pull: the port is opened anew for ever.
TEST_P(BrownOut, LetsTheRunEndAllTheSame) {
  for (double time = 2.0; time < 60.0; time += 0.2) {
    line_.at(time, [this] {
      ++looks_;
      board_.reset();
    });
  }
  line_.run(4.0);
  EXPECT_GT(looks_, 10);
  EXPECT_GT(line_.channel().times_lost, 2U);
  EXPECT_LE(line_.time(), 4.0 + 20.0);
}

class StandsElsewhere : public LeverLine, public testing::WithParamInterface<const char*> {
 protected:
  StandsElsewhere() : LeverLine({.rate = 60.0, .kind = GetParam()}) {}
};
INSTANTIATE_TEST_SUITE_P(Buses, StandsElsewhere, testing::Values("dynamixel", "feetech"),
                         [](const auto& name) { return std::string(name.param); });

// Turned by hand while limp, to where no pose of the platform has them.
TEST_P(StandsElsewhere, IsLedFromThereAtTheRateLimit) {
  Board board = board_at(*device_, device_->home());
  const auto& servos = device_->settings().transport->servos;
  auto& table = dynamic_cast<ServoTableEmulator&>(*board.bus);
  const JointLimits& limits = device_->joint_limits();
  JointAngles standing(3);
  standing << limits.max[0] - 1.0 * deg, limits.min[1] + 1.0 * deg, limits.max[2] - 1.0 * deg;
  Configuration q;
  ASSERT_FALSE(device_->forward_kinematics(standing, q));
  for (std::size_t i = 0; i < 3; ++i) {
    table.turn(i, ServoMap(servos[i]).setpoint(standing[Eigen::Index(i)]));
  }
  line_.plug_in(board);
  line_.at(0.1, [&] {
    ++looks_;
    EXPECT_LE((line_.sent().front().joints - standing).cwiseAbs().maxCoeff(),
              limits.max_rate * 2.0 * line_.period());
  });
  line_.at(4.0, [this] {
    ++looks_;
    EXPECT_LE(away(pressing_), 0.3 * deg);
  });
  line_.run(5.0);
  expect_no_jump();
  EXPECT_EQ(looks_, 2);
}

// Servos that come back stand where they stand, however far those before them had been led.
TEST_P(StandsElsewhere, OthersThatComeBackAreLedFromWhereTheyAre) {
  Board board = board_at(*device_, device_->home());
  Board back = board_at(*device_, pressing_);
  const JointLimits& limits = device_->joint_limits();
  dynamic_cast<ServoTableEmulator&>(*board.bus)
      .turn(1,
            ServoMap(device_->settings().transport->servos[1]).setpoint(limits.max[1] - 1.0 * deg));
  line_.plug_in(board);
  line_.at(0.1, [&] {
    ++looks_;
    EXPECT_GT(away(1, device_->home()), 30.0 * deg) << "it is under way";
    line_.unplug();
    line_.plug_in(back);
  });
  line_.run(2.0);
  const auto first =
      std::ranges::find_if(line_.sent(), [](const auto& one) { return one.time > 0.11; });
  ASSERT_NE(first, line_.sent().end());
  EXPECT_LE((first->joints - joints_at(pressing_)).cwiseAbs().maxCoeff(),
            limits.max_rate * 2.0 * line_.period());
  EXPECT_EQ(looks_, 1);
}

// Beyond what the joints may do, above or below.
TEST_P(StandsElsewhere, AlsoFromBeyondALimit) {
  const auto& servos = device_->settings().transport->servos;
  const JointLimits& limits = device_->joint_limits();
  for (const double sign : {-1.0, 1.0}) {
    SimulatedLine line(device_);
    Board board = board_at(*device_, device_->home());
    JointAngles standing = joints_at(device_->home());
    standing[1] = sign > 0.0 ? limits.max[1] + 6.0 * deg : limits.min[1] - 6.0 * deg;
    dynamic_cast<ServoTableEmulator&>(*board.bus)
        .turn(1, ServoMap(servos[1]).setpoint(standing[1]));
    line.plug_in(board);
    line.wanted = [this](double) { return pressing_; };
    line.at(4.0, [&] {
      ++looks_;
      EXPECT_LE((line.standing() - joints_at(pressing_)).cwiseAbs().maxCoeff(), 0.3 * deg);
    });
    line.run(5.0);
    const double tick = limits.max_rate * 2.0 * line.period();
    EXPECT_LE(std::abs(line.sent().front().joints[1] - standing[1]), tick + 6.0 * deg);
  }
  EXPECT_EQ(looks_, 2);
}

}  // namespace
}  // namespace softfinger
