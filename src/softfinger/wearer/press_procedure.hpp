#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <string>
#include <vector>

#include "softfinger/device/device.hpp"
#include "softfinger/wearer/expected_touch.hpp"
#include "softfinger/wearer/press_plan.hpp"
#include "softfinger/wearer/press_reading.hpp"
#include "softfinger/wearer/sensor_delay.hpp"

namespace softfinger {

/// What is known after one device tick.
struct PressTick {
  double time = 0.0;     ///< s
  Configuration stands;  ///< where the device is
  bool fresh = true;     ///< the sensor's newest reading counts
  double force = 0.0;    ///< N: mean of what came since the last tick, or the newest
  int readings = 1;      ///< how many that were
};

struct PressLimits {
  double guard = 0.8;      ///< N measured, at which a press ends
  double most = 1.0;       ///< N measured, at which the procedure ends
  double touch = 0.05;     ///< N, at which a press begins
  double approach = 3e-3;  ///< m/s
  double press = 1e-3;     ///< m/s
  /// m/s without tilt, as skin is pressed most in use: the more readings say of it the better.
  double straight_press = 0.5e-3;
  double without_life = 1.2e-3;    ///< m past where the skin should be, of a sensor without noise
  double without_growth = 1.5e-3;  ///< m past touch without growth of force
  double duration = 20.0;          ///< s, of all
};

/// Presses by itself: from tilt to tilt, nears the skin, presses on it until the force guard,
/// leaves. No input or output: it is told what is known after each device tick and says where the
/// device is to go for the next. Whoever leads the device retracts it when it is done and when it
/// fails.
class PressProcedure {
 public:
  /// m past where the skin should be that it is looked for by a sensor that shows life.
  static constexpr double kFurthestPast = 2.5e-3;

  /// `tick`: of the device, s.
  PressProcedure(const Device& device, std::vector<PlannedPress> plan, double tick,
                 PressLimits limits = {});

  /// Where the device is to go.
  [[nodiscard]] const Configuration& wanted() const { return wanted_; }
  /// One tick has passed with that.
  void advance(const PressTick& tick);

  [[nodiscard]] bool done() const { return stage_ == Stage::kDone; }
  /// The press under way; null: the sensor's zero is looked for, or all is over.
  [[nodiscard]] const PlannedPress* under_way() const {
    return stage_ == Stage::kZero || done() ? nullptr : &planned();
  }
  /// Which of all that is, from 0.
  [[nodiscard]] std::size_t number() const { return index_; }
  /// Why it ended, in one line; empty while it has not failed.
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// 0 to 1.
  [[nodiscard]] double progress() const;

  /// Readings of all presses, once these are done: zero taken off, each with where the device stood
  /// when what is read was felt.
  [[nodiscard]] const std::vector<PressRecord>& presses() const { return records_; }
  /// Standard deviation of the sensor off the skin, of one tick, N.
  [[nodiscard]] double noise() const { return noise_; }
  /// What it says off the skin, before the first press and between all, N.
  [[nodiscard]] double zero() const { return zero_; }
  /// How late force is known, s: what is still said while the device leaves the skin at once.
  [[nodiscard]] double delay() const { return delay_; }
  /// Greatest force, N.
  [[nodiscard]] double greatest_force() const { return greatest_; }
  [[nodiscard]] double duration() const { return now_ - began_; }

 private:
  enum class Stage : std::uint8_t { kZero, kMove, kApproach, kPress, kLeave, kSettle, kDone };
  /// A reading and how far the device was advanced.
  struct Seen {
    double advance, force;
  };

  void fail(std::string why);
  [[nodiscard]] bool watch(const PressTick& tick);
  void zero(const PressTick& tick);
  void renew_zero();
  void move(const PressTick& tick);
  void approach(const PressTick& tick);
  void press(const PressTick& tick);
  void give_up_press();
  void leave();
  void settle(const PressTick& tick);
  void take_zero_off();
  void begin_press();
  void end_press();
  void next_press();
  /// Of presses that are done.
  [[nodiscard]] bool enough() const;
  void finish();
  /// Moves `wanted_` towards q with this speed of the surface, m/s; true where it is there.
  bool go(const Configuration& q, double speed);
  [[nodiscard]] Configuration at(double advance) const;
  [[nodiscard]] double advance_of(const Configuration& q) const;
  [[nodiscard]] const PlannedPress& planned() const { return plan_[index_]; }
  /// Mean of the last `count` readings, N.
  [[nodiscard]] double recent(std::size_t count) const;
  /// Of the mean of so many readings, N.
  [[nodiscard]] double touch_threshold(std::size_t count) const;
  /// Of the last readings by advance: force there, N, and slope, N/m.
  struct Trend {
    double force = 0.0, slope = 0.0;
  };
  [[nodiscard]] Trend trend() const;
  /// Force that ends a press, N.
  [[nodiscard]] double guard() const;
  /// Of the press under way, m/s.
  [[nodiscard]] double press_speed() const;

  const Device& device_;
  std::vector<PlannedPress> plan_;
  double tick_;
  PressLimits limits_;
  Configuration wanted_;
  Stage stage_ = Stage::kZero;
  std::string failure_;

  double began_ = std::numeric_limits<double>::quiet_NaN();
  double now_ = 0.0;
  double stage_began_ = 0.0;
  double zero_ = 0.0, noise_ = 0.0, greatest_ = 0.0;
  double last_fresh_ = 0.0;
  /// What was said off the skin, zero not taken off.
  struct OffSkin {
    double sum = 0.0, count = 0.0;

    void add(double force) {
      sum += force;
      count += 1.0;
    }
    void add(const OffSkin& other) {
      sum += other.sum;
      count += other.count;
    }
    [[nodiscard]] double mean() const { return sum / count; }
  };
  std::vector<double> zeros_;  ///< before the first press
  double first_zero_ = 0.0;
  OffSkin off_skin_;
  OffSkin moving_;  ///< of the way to the press under way, which may yet touch
  int zero_readings_ = 0;
  std::size_t alike_ = 0;          ///< readings in a row that were the same as the one before
  std::size_t longest_alike_ = 0;  ///< off the skin
  double last_raw_ = std::numeric_limits<double>::quiet_NaN();

  std::size_t index_ = 0;
  std::size_t tried_ = 0;  ///< the press under way, in vain
  double advance_ = 0.0;   ///< wanted, of the press under way, m
  double start_ = 0.0;     ///< of it, off the skin
  double touched_ = 0.0;   ///< where its skin was touched
  double best_ = 0.0;      ///< greatest mean force of it so far, N
  double best_at_ = 0.0;   ///< where that was
  ExpectedTouch expected_;
  SensorDelay late_;
  double delay_ = 0.0;  ///< s
  int pressing_ticks_ = 0;
  bool given_up_ = false;  ///< the press under way
  double clear_ = 0.0;     ///< how much further off the skin a press begins, m
  std::deque<Seen> seen_;  ///< of the press under way, newest last
  PressRecord record_;
  std::vector<PressRecord> records_;
};

}  // namespace softfinger
