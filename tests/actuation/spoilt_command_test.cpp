// Commands that a defect spoils between loop and line are none; in simulated time.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "lever_line.hpp"

namespace softfinger {
namespace {

struct Spoilt {
  const char* name;
  std::function<void(LineChannel::Wanted&)> spoil;
};

class SpoiltCommand : public LeverLine, public testing::WithParamInterface<Spoilt> {
 protected:
  SpoiltCommand() : LeverLine({.rate = 60.0}) { line_.plug_in(board_); }
  Board board_ = board_at(*device_, device_->home());
};

INSTANTIATE_TEST_SUITE_P(
    Fields, SpoiltCommand,
    testing::Values(Spoilt{"Coordinate", [](LineChannel::Wanted& wanted) { wanted.q[1] += 1e-12; }},
                    Spoilt{"CoordinateThatIsNone",
                           [](LineChannel::Wanted& wanted) {
                             wanted.q[0] = std::numeric_limits<double>::quiet_NaN();
                           }},
                    Spoilt{"Sign", [](LineChannel::Wanted& wanted) { wanted.q[2] = -wanted.q[2]; }},
                    Spoilt{"State",
                           [](LineChannel::Wanted& wanted) {
                             wanted.state = DeviceState::kRendering;
                           }},
                    Spoilt{"Number", [](LineChannel::Wanted& wanted) { ++wanted.number; }},
                    Spoilt{"Time", [](LineChannel::Wanted& wanted) { wanted.formed = 1.0; }},
                    Spoilt{"OldOne",
                           [](LineChannel::Wanted& wanted) {
                             wanted.number = 1;
                             wanted.seal = wanted.seal_of_this();
                           }},
                    Spoilt{"TheLastOneAgain",
                           [last = std::uint64_t{0}](LineChannel::Wanted& wanted) mutable {
                             if (last == 0) last = wanted.number - 1;
                             wanted.number = last;
                             wanted.seal = wanted.seal_of_this();
                           }},
                    Spoilt{"Size",
                           [](LineChannel::Wanted& wanted) {
                             // As a stray write would, past Eigen's own checks.
                             *reinterpret_cast<Eigen::Index*>(
                                 reinterpret_cast<char*>(&wanted.q) +
                                 sizeof(double) * kMaxDegreesOfFreedom) = 1'000'000'000;
                           }}),
    [](const auto& spoilt) { return std::string(spoilt.param.name); });

TEST_P(SpoiltCommand, IsNoneSoThatTheDeviceRetractsUntilAGoodOneComes) {
  line_.at(2.0, [this] {
    ++looks_;
    EXPECT_LE(away(pressing_), 0.3 * deg);
    EXPECT_EQ(line_.channel().commands_refused.load(), 0U);
    line_.spoil = GetParam().spoil;
  });
  line_.at(4.0, [this] {
    ++looks_;
    EXPECT_GT(line_.channel().commands_refused.load(), 50U);
    EXPECT_EQ(line_.channel().times_stalled.load(), 1U);
    EXPECT_LE(away(device_->retracted()), 0.3 * deg);
    line_.spoil = nullptr;
  });
  line_.at(6.0, [this] {
    ++looks_;
    EXPECT_LE(away(pressing_), 0.3 * deg);
  });
  line_.run(6.5);
  EXPECT_EQ(looks_, 3);
  expect_no_jump();
}

class LineThatTakesOver : public LeverLine {
 protected:
  LineThatTakesOver() : LeverLine({.rate = 60.0}) {}
};

TEST_F(LineThatTakesOver, WhatAnotherLineIsSaidToHaveSentIsNotBelievedWhereItIsSpoilt) {
  Board board = board_at(*device_, device_->home());
  board.reset();  // so that the servos themselves say nothing
  line_.plug_in(board);
  line_.spoil_sent = [](LineChannel::Sent& sent) { sent.q[2] += 5.0 * mm; };
  line_.was_sent_before(pressing_);
  line_.at(0.5, [this] { line_.stop(); });
  line_.run(2.0);
  ASSERT_FALSE(line_.sent().empty());
  const double tick = device_->joint_limits().max_rate * line_.period();
  EXPECT_LE((line_.sent().front().joints - joints_at(device_->home())).cwiseAbs().maxCoeff(),
            1.5 * tick);
}

}  // namespace
}  // namespace softfinger
