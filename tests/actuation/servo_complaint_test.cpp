// What servos say of themselves, and what they do by themselves where nobody speaks to them; in
// simulated time.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "lever_line.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"

namespace softfinger {
namespace {

/// From what a servo says to the device retracted, s: what the docs promise.
constexpr double kUntilFree = 4.0;

struct Trouble {
  const char* name;
  const char* kind;
  std::uint8_t errors;  ///< as the servo's register has them
  int temperature;      ///< degrees Celsius
  ServoComplaint complaint;
};

class ServoComplains : public LeverLine, public testing::WithParamInterface<Trouble> {
 protected:
  ServoComplains() : LeverLine({.rate = 60.0, .kind = GetParam().kind}) { line_.plug_in(board_); }

  Board board_ = board_at(*device_, device_->home());
  ServoTableEmulator& servos_ = dynamic_cast<ServoTableEmulator&>(*board_.bus);
};

INSTANTIATE_TEST_SUITE_P(
    Buses, ServoComplains,
    testing::Values(Trouble{"DynamixelVoltage", "dynamixel", 1U << 0, 40, kBadVoltage},
                    Trouble{"DynamixelHeat", "dynamixel", 1U << 2, 40, kTooHot},
                    Trouble{"DynamixelEncoder", "dynamixel", 1U << 3, 40, kDefect},
                    Trouble{"DynamixelShock", "dynamixel", 1U << 4, 40, kDefect},
                    Trouble{"DynamixelOverload", "dynamixel", 1U << 5, 40, kOverload},
                    Trouble{"DynamixelTemperature", "dynamixel", 0, 71, kTooHot},
                    Trouble{"FeetechVoltage", "feetech", 1U << 0, 40, kBadVoltage},
                    Trouble{"FeetechSensor", "feetech", 1U << 1, 40, kDefect},
                    Trouble{"FeetechHeat", "feetech", 1U << 2, 40, kTooHot},
                    Trouble{"FeetechCurrent", "feetech", 1U << 3, 40, kOverload},
                    Trouble{"FeetechOverload", "feetech", 1U << 5, 40, kOverload},
                    Trouble{"FeetechTemperature", "feetech", 0, 71, kTooHot}),
    [](const auto& trouble) { return std::string(trouble.param.name); });

TEST_P(ServoComplains, TheDeviceRetractsAndStaysSoUntilItIsWellAndSomebodyReleases) {
  servos_.heat(1, 70);  // as much as it may
  line_.at(2.0, [this] {
    ++looks_;
    EXPECT_LE(away(pressing_), 0.3 * deg);
    EXPECT_FALSE(line_.channel().stop.is_stopped());
    servos_.complain(1, GetParam().errors);
    servos_.heat(1, static_cast<std::uint8_t>(GetParam().temperature));
  });
  line_.at(2.0 + kUntilFree, [this] {
    ++looks_;
    const StopLatch& stop = line_.channel().stop;
    EXPECT_TRUE(stop.is_stopped());
    EXPECT_EQ(stop.cause(), StopCause::kServo);
    EXPECT_EQ(line_.channel().complaints[1].load(), GetParam().complaint);
    EXPECT_EQ(line_.channel().complaints[0].load(), 0);
    EXPECT_EQ(line_.channel().faults.load().any(), 0U);
    EXPECT_LE(away(device_->retracted()), 0.3 * deg) << "it can be led all the same";
    line_.ask_release(stop.newest());
  });
  line_.at(7.0, [this] {
    ++looks_;
    EXPECT_TRUE(line_.channel().stop.is_stopped());
    EXPECT_EQ(line_.channel().stop.refusal(), ReleaseRefusal::kServoFault);
    servos_.complain(1, 0);
    servos_.heat(1, 40);
  });
  line_.at(9.0, [this] { line_.ask_release(line_.channel().stop.newest()); });
  line_.at(11.0, [this] {
    ++looks_;
    EXPECT_FALSE(line_.channel().stop.is_stopped());
    EXPECT_LE(away(pressing_), 0.3 * deg);
  });
  line_.run(11.5);
  EXPECT_EQ(looks_, 4);
}

TEST(ServoThatComplains, IsAnyOfThem) {
  const auto device = lever_platform({.rate = 60.0, .kind = "dynamixel"});
  for (std::size_t servo = 0; servo < 3; ++servo) {
    SimulatedLine line(device);
    Board board = board_at(*device, device->home());
    line.plug_in(board);
    line.wanted = [&](double) { return device->home(); };
    line.at(2.0, [&] { dynamic_cast<ServoTableEmulator&>(*board.bus).complain(servo, 1U << 5); });
    line.run(3.0);
    EXPECT_TRUE(line.channel().stop.is_stopped()) << servo;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(line.channel().complaints[i].load(), i == servo ? kOverload : 0) << servo << i;
    }
  }
}

TEST(ServoThatIsNotAsked, MayBeAsHotAsItLikes) {
  LeverShape shape{.rate = 60.0, .kind = "dynamixel"};
  shape.max_temperature = 0;
  const auto device = lever_platform(shape);
  SimulatedLine line(device);
  Board board = board_at(*device, device->home());
  dynamic_cast<ServoTableEmulator&>(*board.bus).heat(0, 99);
  line.plug_in(board);
  line.wanted = [&](double) { return device->home(); };
  line.run(3.0);
  EXPECT_GT(line.sent().size(), 10u);
  EXPECT_FALSE(line.channel().stop.is_stopped());
}

class BusWatchdog : public LeverLine, public testing::WithParamInterface<double> {
 protected:
  BusWatchdog() : LeverLine({.rate = GetParam(), .kind = "dynamixel"}) { line_.plug_in(board_); }
  [[nodiscard]] bool has_barked() const {
    return servos_.has_barked(0) || servos_.has_barked(1) || servos_.has_barked(2);
  }
  /// Nothing reaches the servos in this time, s.
  void cut_wire(double from, double to) {
    line_.to_board = [=, this](SimulatedLine::Bytes& bytes) {
      if (line_.time() >= from && line_.time() < to) bytes.clear();
    };
  }

  Board board_ = board_at(*device_, device_->home());
  ServoTableEmulator& servos_ = dynamic_cast<ServoTableEmulator&>(*board_.bus);
};
INSTANTIATE_TEST_SUITE_P(Rates, BusWatchdog, testing::Values(1.0, 4.0, 10.0, 60.0, 200.0),
                         [](const auto& rate) {
                           return std::to_string(static_cast<int>(rate.param)) + "Hz";
                         });

TEST_P(BusWatchdog, WatchesOverARunAndNotAfterIt) {
  for (const double time : {3.0, 9.0, 19.0}) {
    line_.at(time, [this] {
      ++looks_;
      EXPECT_FALSE(has_barked());
      // A second or five ticks, as far as its register goes.
      const double patience = std::min(std::max(1.0, 5.0 * line_.period()), 2.54);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(servos_.value(i, servos_.table().watchdog), patience / kWatchdogUnit, 1.0);
      }
    });
  }
  line_.run(20.0);
  EXPECT_EQ(looks_, 3);
  EXPECT_FALSE(has_barked());
  EXPECT_EQ(line_.channel().times_lost, 0U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(servos_.value(i, servos_.table().watchdog), 0U) << "another program finds it off";
  }
}

TEST_P(BusWatchdog, StopsServosThatHearNothing) {
  cut_wire(8.0, 1e9);
  line_.at(8.0 + 3.0, [this] {
    ++looks_;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_TRUE(servos_.has_barked(i));
      EXPECT_TRUE(servos_.torque(i)) << "a Dynamixel stops, and holds where it is";
    }
  });
  line_.run(11.5);
  EXPECT_EQ(looks_, 1);
}

TEST_P(BusWatchdog, IsNoticedAndTheServosAreLedOn) {
  const double least = servos_.value(0, servos_.table().watchdog);
  EXPECT_EQ(least, 0.0) << "nobody has asked for it yet";
  cut_wire(8.0, 11.0);
  line_.at(10.9, [this] {
    ++looks_;
    EXPECT_TRUE(has_barked());
  });
  // Eight ticks by three questions until it is seen, and then the way there.
  const double seen = 11.0 + 24.0 * line_.period() + 8.0 * line_.period() + 6.0;
  line_.at(seen, [this] {
    ++looks_;
    EXPECT_FALSE(has_barked());
    EXPECT_LE(away(pressing_), 0.3 * deg);
    EXPECT_GE(line_.channel().times_lost, 1U);
  });
  line_.run(seen + 1.0);
  EXPECT_EQ(looks_, 2);
  expect_no_jump();
  EXPECT_LE(away(device_->retracted()), 0.3 * deg);
}

}  // namespace
}  // namespace softfinger
