// The presses by which a device learns its wearer, on fingers made of springs.

#include "softfinger/wearer/press_procedure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "../support/folders.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {
namespace {

const std::filesystem::path kPressProject = source_folder();
constexpr double kTick = 1.0 / 30.0;

/// Force by how far the device stands beyond the resting skin (m) and time (s); the sensor says it
/// two ticks late.
using Spring = std::function<double(double depth, double time)>;
/// What becomes of what the sensor says.
using Sensor = std::function<void(PressTick& tick)>;

double pad(double depth, double /*time*/) {
  return depth <= 0.0 ? 0.0 : 0.19 / 2.1 * (std::exp(2.1 * depth / mm) - 1.0);
}

class PressProcedureTest : public testing::Test {
 protected:
  struct Pressed {
    std::string failure;
    bool done = false;
    std::size_t presses = 0;
    double greatest = 0.0;  ///< true force, N
    double time = 0.0;
    bool retracts = false;
    double delay = 0.0;  ///< s, as it was noticed
    double zero = 0.0;   ///< N, the same
    std::vector<PressRecord> records;
    double misread = 0.0;  ///< N: the furthest that a reading is off what was felt where it is said
  };

  [[nodiscard]] Pressed press(const Spring& spring, const Sensor& sensor = {},
                              double further_off = 0.0, bool once_more = false) const {
    std::vector<PlannedPress> plan = plan_;
    if (once_more) {
      plan.push_back(plan.front());
      plan.back().spare = true;
    }
    PressProcedure procedure(*device_, plan, kTick);
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    std::deque<double> late{0.0, 0.0};
    Pressed pressed;
    Configuration stands = device_->home();
    for (int i = 0; i < 900 && !procedure.done() && procedure.failure().empty(); ++i) {
      stands = procedure.wanted();
      const double time = i * kTick;
      const double depth = depth_of(stands) - further_off;
      late.push_back(spring(depth, time));
      pressed.greatest = std::max(pressed.greatest, late.back());
      PressTick tick{.time = time,
                     .stands = stands,
                     .fresh = true,
                     .force = late.front() + 0.01 * normal(random),
                     .readings = 3};
      late.pop_front();
      if (sensor) sensor(tick);
      procedure.advance(tick);
    }
    pressed.failure = procedure.failure();
    pressed.done = procedure.done();
    pressed.presses = procedure.presses().size();
    pressed.records = procedure.presses();
    pressed.time = procedure.duration();
    pressed.delay = procedure.delay();
    pressed.zero = procedure.zero();
    pressed.retracts = procedure.wanted() == device_->retracted();
    for (const PressRecord& record : procedure.presses()) {
      for (std::size_t k = 1; k < record.readings.size(); ++k) {
        EXPECT_GT(record.readings[k].q[2], record.readings[k - 1].q[2]) << "only while loading";
      }
      for (const PressReading& reading : record.readings) {
        const double off = reading.force - spring(depth_of(reading.q) - further_off, 0.0);
        pressed.misread = std::max(pressed.misread, std::abs(off));
      }
    }
    return pressed;
  }

  void expect_failure(const Pressed& pressed, const char* word) const {
    EXPECT_FALSE(pressed.done);
    EXPECT_NE(pressed.failure.find(word), std::string::npos) << pressed.failure;
    EXPECT_EQ(pressed.failure.find('\n'), std::string::npos);
    EXPECT_TRUE(pressed.retracts);
  }

 private:
  /// Beyond the model's resting skin at the tilt of q, m.
  [[nodiscard]] double depth_of(const Configuration& q) const {
    double sum = 0.0;
    double weights = 0.0;
    for (const PlannedPress& press : plan_) {
      const double off = (press.tilted.head<2>() - q.head<2>()).norm() + 0.01 * deg;
      const double weight = std::pow(off, -4.0);
      sum += weight * press.touch;
      weights += weight;
    }
    const double touch = sum / weights;
    return q[2] - touch;
  }

 protected:
  std::shared_ptr<const FingerModel> finger_ =
      FingerModel::load(kPressProject / "fingers" / "index.toml");
  std::shared_ptr<const Device> device_ =
      load_device(kPressProject / "devices" / "thimble-3rrs.toml");
  std::vector<PlannedPress> plan_ = plan_presses(*device_, *finger_, 1.5 * mm);
};

TEST_F(PressProcedureTest, PressesNineTimesWithinTwentySecondsAndNeverHard) {
  ASSERT_EQ(plan_.size(), 9U);
  for (const double nearer : {-1.0, 0.0, 1.0}) {
    for (const double stiffness : {0.6, 1.0, 1.8}) {
      const Pressed pressed = press(
          [&](double depth, double time) { return stiffness * pad(depth + nearer * mm, time); });
      EXPECT_TRUE(pressed.done) << pressed.failure;
      EXPECT_GE(pressed.presses, 5U);
      EXPECT_LE(pressed.time, 20.0);
      EXPECT_GT(pressed.greatest, 0.6);
      EXPECT_LE(pressed.greatest, 1.0) << "two ticks late";
      if (nearer == 0.0) {
        EXPECT_EQ(pressed.presses, 9U);
      }
    }
  }
}

TEST_F(PressProcedureTest, KeepsWhatWasFeltOnTheWayToTheFirstReading) {
  const Pressed pressed = press([](double depth, double time) { return pad(depth, time); });
  ASSERT_EQ(pressed.records.size(), 9U) << pressed.failure;
  for (const PressRecord& record : pressed.records) {
    ASSERT_GE(record.approach.size(), 5U);
    ASSERT_GE(record.readings.size(), 5U);
    EXPECT_NEAR(record.approach.front().force, 0.0, 0.08) << "off the skin";
    EXPECT_GT(record.approach.back().force, 0.02);
    double time = record.approach.front().time - kTick;
    for (const std::vector<PressReading>* readings : {&record.approach, &record.readings}) {
      for (const PressReading& reading : *readings) {
        EXPECT_NEAR(reading.time - time, kTick, 1e-9) << "none is missing";
        time = reading.time;
      }
    }
  }
}

/// Of the first readings of a press, m/s.
double speed_of(const PressRecord& record) {
  const PressReading& first = record.readings.at(0);
  const PressReading& later = record.readings.at(4);
  return (later.q[2] - first.q[2]) / (later.time - first.time);
}

TEST_F(PressProcedureTest, PressesHalfAsFastStraightOn) {
  const Pressed pressed = press([](double depth, double time) { return 0.6 * pad(depth, time); });
  ASSERT_EQ(pressed.records.size(), 9U) << pressed.failure;
  for (std::size_t k = 0; k < 9; ++k) {
    ASSERT_GE(pressed.records[k].readings.size(), 5U);
    EXPECT_NEAR(speed_of(pressed.records[k]), k == 0 ? 0.5e-3 : 1e-3, 1e-5) << k;
  }
}

TEST_F(PressProcedureTest, PressesStraightOnOnceMoreWhereThereIsTime) {
  const auto quick = [](double depth, double time) { return 1.8 * pad(depth, time); };
  const Pressed again = press(quick, {}, 0.0, true);
  ASSERT_EQ(again.records.size(), 10U) << again.failure;
  EXPECT_LE(again.time, 20.0);
  EXPECT_LT(speed_of(again.records.back()), 0.51e-3);
  // Skin that is further off takes the time.
  const auto slow = [](double depth, double time) { return 0.3 * pad(depth - 1.0 * mm, time); };
  const Pressed late = press(slow, {}, 0.0, true);
  EXPECT_EQ(late.records.size(), 9U) << late.failure;
  EXPECT_GT(late.time, 20.0 - 3.2);
}

TEST_F(PressProcedureTest, ANoisySensorEndsPressesEarlier) {
  const auto greatest_with = [&](double noise) {
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    const Pressed pressed =
        press(pad, [&](PressTick& tick) { tick.force += noise * normal(random); });
    EXPECT_TRUE(pressed.done) << pressed.failure;
    double sum = 0.0;
    for (const PressRecord& record : pressed.records) {
      const auto& last = record.readings;
      for (std::size_t i = last.size() - 3; i < last.size(); ++i) sum += last[i].force / 3.0;
    }
    return sum / static_cast<double>(pressed.records.size());
  };
  const double quiet = greatest_with(0.02);
  const double noisy = greatest_with(0.1);
  EXPECT_GT(quiet, 0.6);
  EXPECT_LT(noisy, quiet - 0.05);
  EXPECT_GT(noisy, 0.4);
}

TEST_F(PressProcedureTest, TakesItsZeroFromAllReadingsOffTheSkin) {
  constexpr double kZero = -3.0;   // N
  constexpr double kNoise = 0.05;  // N
  constexpr int kSensors = 8;
  double square = 0.0;
  for (unsigned seed = 0; seed < kSensors; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(kZero, kNoise);
    const Pressed pressed =
        press([](double depth, double) { return std::max(0.8 * depth / mm, 0.0); },
              [&](PressTick& tick) { tick.force += noise(random); });
    EXPECT_TRUE(pressed.done) << pressed.failure;
    square += (pressed.zero - kZero) * (pressed.zero - kZero);
  }
  // Half a second are 15 readings.
  EXPECT_LT(std::sqrt(square / kSensors), kNoise / std::sqrt(60.0));
}

TEST_F(PressProcedureTest, TakesNothingForItsZeroThatIsNoNoise) {
  const Pressed pressed = press(pad, [](PressTick& tick) {
    if (tick.time > 2.0) tick.force += 0.03;  // something leans on it
  });
  EXPECT_TRUE(pressed.done) << pressed.failure;
  EXPECT_LT(pressed.zero, 0.014);
}

TEST_F(PressProcedureTest, NoticesHowLateTheSensorIs) {
  const Pressed late = press(pad);
  ASSERT_TRUE(late.done) << late.failure;
  EXPECT_NEAR(late.delay, 2.0 * kTick, 0.2 * kTick);
  EXPECT_LT(late.misread, 0.06) << "0.13 N grow in two ticks where the pad is stiffest";
}

TEST_F(PressProcedureTest, ASensorThatIsDead) {
  const Pressed pressed = press(pad, [](PressTick& tick) { tick.force = 0.0; });
  expect_failure(pressed, "dead or stuck");
  EXPECT_LT(pressed.greatest, 1.5);
}

TEST_F(PressProcedureTest, ASensorThatIsStuckFromTheStart) {
  expect_failure(press(pad, [](PressTick& tick) { tick.force = 0.3; }), "dead or stuck");
}

TEST_F(PressProcedureTest, ASensorThatSticksUnderLoad) {
  double last = 0.0;
  const Pressed pressed = press(pad, [&](PressTick& tick) {
    if (last > 0.3) tick.force = last;
    last = tick.force;
  });
  expect_failure(pressed, "stuck");
}

TEST_F(PressProcedureTest, ASensorThatIsReversed) {
  const Pressed pressed = press(pad, [](PressTick& tick) { tick.force = -tick.force; });
  expect_failure(pressed, "reversed");
  EXPECT_LT(pressed.greatest, 1.0);
}

TEST_F(PressProcedureTest, ASensorThatIsTooNoisy) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const Pressed pressed = press(pad, [&](PressTick& tick) { tick.force += 0.4 * normal(random); });
  expect_failure(pressed, "too noisy");
  EXPECT_EQ(pressed.greatest, 0.0) << "nobody was touched";
}

TEST_F(PressProcedureTest, ASensorThatIsTooSlow) {
  int ticks = 0;
  const Pressed pressed =
      press(pad, [&](PressTick& tick) { tick.readings = ++ticks % 3 == 0 ? 1 : 0; });
  expect_failure(pressed, "too slow");
  EXPECT_EQ(pressed.greatest, 0.0);
}

TEST_F(PressProcedureTest, ASensorThatFallsSilent) {
  const Pressed pressed = press(pad, [](PressTick& tick) { tick.fresh = tick.time < 2.5; });
  expect_failure(pressed, "has said nothing");
  EXPECT_LT(pressed.time, 3.0);
}

TEST_F(PressProcedureTest, ASensorThatNeverSpeaks) {
  const Pressed pressed = press(pad, [](PressTick& tick) { tick.fresh = false; });
  expect_failure(pressed, "has said nothing");
  EXPECT_EQ(pressed.greatest, 0.0);
}

TEST_F(PressProcedureTest, AWearerWhoPullsAway) {
  double most = 0.0;
  bool pulls = false;
  const Pressed pressed = press([&](double depth, double time) {
    const double force = pad(depth, time);
    most = std::max(most, force);
    pulls = pulls || most > 0.5;
    return pulls ? 0.0 : force;
  });
  expect_failure(pressed, "pulls away");
}

TEST_F(PressProcedureTest, AWearerWhoPressesBack) {
  const Pressed sudden = press(
      [&](double depth, double time) { return pad(depth, time) + (depth > 0.3 * mm ? 1.5 : 0.0); });
  expect_failure(sudden, "presses back");
  const Pressed follows =
      press([&](double depth, double time) { return time > 3.0 ? 0.4 : pad(depth, time); });
  expect_failure(follows, "");
  EXPECT_NE(follows.failure, "");
}

TEST_F(PressProcedureTest, ADeviceThatIsOffTheFinger) {
  const Pressed pressed = press(pad, {}, 20.0 * mm);
  expect_failure(pressed, "off the finger");
  EXPECT_EQ(pressed.greatest, 0.0);
}

TEST_F(PressProcedureTest, ADeviceThatIsTooSlow) {
  const Pressed pressed = press(pad, [](PressTick& tick) { tick.time *= 3.0; });
  expect_failure(pressed, "longer than 20 s");
}

TEST(PressPlan, LimitsThatForbidTheTiltsAreNamed) {
  const auto finger = FingerModel::load(kPressProject / "fingers" / "index.toml");
  const auto file = kPressProject / "devices" / "thimble-3rrs.toml";
  std::string text = load_device(file)->settings().text;
  const std::string limit = "max_tilt_deg = 30.0";
  text.replace(text.find(limit), limit.size(), "max_tilt_deg = 10.0");
  try {
    (void)plan_presses(*load_device(file, text, 0.0), *finger, 1.5 * mm);
    FAIL() << "planned";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("15 degrees"), std::string::npos) << error.what();
  }
}

TEST(PressPlan, LeavesOutWhatADeviceCannot) {
  const auto finger = FingerModel::load(kPressProject / "fingers" / "index.toml");
  const auto presses_of = [&](const char* name) {
    const auto device = load_device(kPressProject / "devices" / (std::string(name) + ".toml"));
    return plan_presses(*device, *finger, 1.0 * mm).size();
  };
  EXPECT_EQ(presses_of("plate-2dof"), 3U);
  EXPECT_EQ(presses_of("disk-linear"), 1U);
}

}  // namespace
}  // namespace softfinger
