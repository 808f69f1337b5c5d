// When a line does what it does, to the tick; in simulated time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "lever_line.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"

namespace softfinger {
namespace {

constexpr double kInstant = 1.5e-3;  ///< what simulated steps of waiting add up to, s

Configuration lifted(double travel) {
  Configuration q = Configuration::Zero(3);
  q[2] = travel;
  return q;
}

/// A line of some rate with its board.
struct TimedLine {
  explicit TimedLine(double rate, const char* kind = "maestro", bool limp_at_end = false)
      : device(lever_platform({.rate = rate, .kind = kind, .limp_at_end = limp_at_end})),
        board(board_at(*device, device->home())),
        line(device) {
    line.plug_in(board);
    line.wanted = [](double) { return lifted(3.0 * mm); };
  }
  /// Times between commands that were sent in [from, to).
  [[nodiscard]] std::vector<double> intervals(double from, double to) const {
    std::vector<double> found;
    for (std::size_t k = 1; k < line.sent().size(); ++k) {
      const double time = line.sent()[k].time;
      if (time >= from && time < to) found.push_back(time - line.sent()[k - 1].time);
    }
    return found;
  }
  /// When a command last (or first) differed from the one before it, in [from, to).
  [[nodiscard]] std::vector<double> changes(double from, double to) const {
    std::vector<double> found;
    for (std::size_t k = 1; k < line.sent().size(); ++k) {
      const auto& now = line.sent()[k];
      if (now.time < from || now.time >= to) continue;
      if (now.joints != line.sent()[k - 1].joints) found.push_back(now.time);
    }
    return found;
  }

  std::shared_ptr<const Device> device;
  Board board;
  SimulatedLine line;
};

void expect_all(const std::vector<double>& times, double expected, std::size_t least) {
  EXPECT_GE(times.size(), least);
  for (const double time : times) EXPECT_NEAR(time, expected, kInstant);
}

// A command that is late is waited for half a tick, and a loop that says nothing for a tenth of a
// second and three ticks stalls.
TEST(ServoLineTiming, RepeatsWhatIsLateAndRetractsWhereNothingComes) {
  for (const auto& [rate, last_fresh, stall] :
       {std::tuple(50.0, 0.98, 1.10), std::tuple(10.0, 0.9, 1.20)}) {
    TimedLine timed(rate);
    SimulatedLine& line = timed.line;
    line.wanted = [](double time) {
      return time < 0.999 ? std::optional(lifted(3.0 * mm)) : std::nullopt;
    };
    line.run(3.0);
    const double period = line.period();
    expect_all(timed.intervals(0.5, last_fresh + 0.5 * period), period, 4);
    expect_all(timed.intervals(last_fresh + 0.5 * period, stall + 0.5 * period), 1.5 * period, 2);
    expect_all(timed.intervals(stall + 0.5 * period, 2.9), period, 10);
    const auto changes = timed.changes(0.7, 3.0);
    ASSERT_FALSE(changes.empty());
    EXPECT_NEAR(changes.front(), stall, kInstant) << rate;
    EXPECT_EQ(line.channel().times_stalled.load(), 1U);
  }
}

// A Maestro that says nothing is asked for its errors for 50 ms, and for positions for a quarter of
// a second in steps of 20 ms; one that answers is looked at after 60 ms.
TEST(ServoLineTiming, StartsAsSoonAsItKnowsOrGivesUp) {
  TimedLine heard(50.0);
  heard.line.run(1.0);
  ASSERT_FALSE(heard.line.sent().empty());
  EXPECT_NEAR(heard.line.sent().front().time, 0.06 + 3.3e-3, kInstant);
  TimedLine mute(50.0);
  mute.line.from_board = [](SimulatedLine::Bytes& bytes) { bytes.clear(); };
  mute.line.run(1.0);
  ASSERT_FALSE(mute.line.sent().empty());
  EXPECT_NEAR(mute.line.sent().front().time, 0.05 + 0.26, kInstant);
}

TEST(ServoLineTiming, AtTheEndAPortIsWaitedForThreeSeconds) {
  TimedLine timed(50.0);
  timed.line.at(1.5, [&] { timed.line.unplug(); });
  timed.line.run(2.0);
  EXPECT_NEAR(timed.line.time(), 4.5 + timed.line.period(), 1.1 * timed.line.period());
}

TEST(ServoLineTiming, NoEndTakesLongerThanFifteenSecondsWhateverAPortDoes) {
  TimedLine timed(50.0);
  int blinks = 0;
  for (double time = 1.9; time < 40.0; time += 0.85) {
    timed.line.at(time, [&] {
      ++blinks;
      timed.line.unplug();
    });
    timed.line.at(time + 0.5, [&] { timed.line.plug_in(timed.board); });
  }
  timed.line.run(2.0);
  EXPECT_GE(timed.line.time(), 17.0);
  EXPECT_LE(timed.line.time(), 18.0 + 1.0) << "and the second that the test waits";
  EXPECT_GT(blinks, 15);
}

// Three ticks, and a tenth of a second.
TEST(ServoLineTiming, StandsWhereServosThatSpokeSayNothing) {
  for (const auto& [rate, most] : {std::pair(50.0, 5), std::pair(20.0, 3)}) {
    TimedLine timed(rate);
    SimulatedLine& line = timed.line;
    line.wanted = [](double time) { return lifted(0.5 * mm * std::sin(7.0 * time)); };
    const double period = line.period();
    line.at(1.0 + 0.2 * period,
            [&] { line.from_board = [](SimulatedLine::Bytes& bytes) { bytes.clear(); }; });
    line.at(2.0, [&] { line.from_board = nullptr; });
    line.run(3.0);
    const auto silent = timed.changes(1.0 + 0.2 * period, 2.0 + 0.2 * period);
    ASSERT_FALSE(silent.empty());
    EXPECT_NEAR(silent.back(), 1.0 + (1 + most) * period, kInstant) << rate;
    EXPECT_GT(timed.changes(2.2, 2.9).size(), 5U) << "and goes on";
  }
}

// For servos that are to let go a second is enough to be retracted.
TEST(ServoLineTiming, WaitsASecondForAServoThatIsStuckBeforeItLetsGo) {
  for (const bool stuck : {false, true}) {
    TimedLine timed(50.0, "dynamixel", true);
    SimulatedLine& line = timed.line;
    if (stuck) {
      line.at(1.9, [&] { dynamic_cast<ServoTableEmulator&>(*timed.board.bus).block(2); });
    }
    line.run(2.0);
    // The way, its repeats, and the second that the test waits.
    EXPECT_GE(line.time(), 2.0 + 0.3 + 1.0 + (stuck ? 1.0 : 0.0));
    EXPECT_LE(line.time(), 2.0 + 0.3 + 1.0 + (stuck ? 1.0 : 0.0) + 0.3) << stuck;
  }
}

}  // namespace
}  // namespace softfinger
