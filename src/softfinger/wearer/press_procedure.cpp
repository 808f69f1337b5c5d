#include "softfinger/wearer/press_procedure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kZeroTime = 0.5;          // s, off the skin
constexpr double kStandTime = 0.2;         // s, before that: the device comes to rest
constexpr double kLeastReadings = 20.0;    // a second
constexpr double kMostNoise = 0.15;        // N, standard deviation
constexpr double kStale = 0.25;            // s
constexpr double kLeaveSpeed = 25.0 * mm;  // a second
constexpr double kMoveSpeed = 30.0 * mm;   // a second, of the surface
constexpr double kClear = 0.8 * mm;        // off the skin, where a press begins
constexpr double kClearer = 0.8 * mm;      // more, after a press that began on the skin
constexpr double kBeyond = 1.0 * mm;       // without touch, of a sensor that shows life
constexpr double kGrowth = 0.05;           // N, that counts as growth
constexpr double kReversed = 0.1;          // N
constexpr double kLostPart = 0.5;          // of the greatest force of a press
constexpr double kLeftOver = 0.12;         // N, off the skin
constexpr int kSettleTicks = 5;
constexpr int kDelayTicks = 3;            // until a force that is too large ends
constexpr int kSteadyTicks = 3;           // after a change of speed
constexpr double kMostGrowth = 0.12;      // N, that may come within the delay
constexpr double kSlowest = 0.25;         // of the speed of a press
constexpr std::size_t kLeastOfPress = 5;  // readings
constexpr std::size_t kTries = 2;
constexpr std::size_t kRecent = 4;
constexpr std::size_t kTrend = 8;
constexpr double kOnePress = 2.2;  // s, with the way there
constexpr double kLightest = 0.5;  // of the guard, that each press must have come to

}  // namespace

PressProcedure::PressProcedure(const Device& device, std::vector<PlannedPress> plan, double tick,
                               PressLimits limits)
    : device_(device),
      plan_(std::move(plan)),
      tick_(tick),
      limits_(limits),
      wanted_(device.home()),
      clear_(kClear) {}

void PressProcedure::fail(std::string why) {
  if (failure_.empty()) failure_ = std::move(why);
  wanted_ = device_.retracted();
}

double PressProcedure::progress() const {
  if (done()) return 1.0;
  return static_cast<double>(records_.size()) / static_cast<double>(plan_.size());
}

Configuration PressProcedure::at(double advance) const {
  Configuration q = planned().tilted;
  device_.advance(advance, q);
  return q;
}

double PressProcedure::advance_of(const Configuration& q) const {
  Configuration ahead = Configuration::Zero(q.size());
  device_.advance(1.0, ahead);
  return (q - planned().tilted).dot(ahead) / ahead.squaredNorm();
}

bool PressProcedure::go(const Configuration& q, double speed) {
  const double way = std::sqrt(device_.squared_distance(q, wanted_));
  const double step = speed * tick_;
  if (way <= step) {
    wanted_ = q;
    return true;
  }
  wanted_ += (q - wanted_) * (step / way);
  return false;
}

double PressProcedure::recent(std::size_t count) const {
  const std::size_t taken = std::min(count, seen_.size());
  if (taken == 0) return 0.0;
  double sum = 0.0;
  for (std::size_t i = seen_.size() - taken; i < seen_.size(); ++i) sum += seen_[i].force;
  return sum / static_cast<double>(taken);
}

PressProcedure::Trend PressProcedure::trend() const {
  const std::size_t taken = std::min(kTrend, seen_.size());
  const auto n = static_cast<double>(taken);
  double s = 0.0;
  double f = 0.0;
  for (std::size_t i = seen_.size() - taken; i < seen_.size(); ++i) {
    s += seen_[i].advance / n;
    f += seen_[i].force / n;
  }
  double ss = 0.0;
  double sf = 0.0;
  for (std::size_t i = seen_.size() - taken; i < seen_.size(); ++i) {
    ss += (seen_[i].advance - s) * (seen_[i].advance - s);
    sf += (seen_[i].advance - s) * (seen_[i].force - f);
  }
  if (!(ss > 0.0)) return {f, 0.0};
  const double slope = std::max(sf / ss, 0.0);
  return {f + slope * (seen_.back().advance - s), slope};
}

/// What ends it whatever it does; true: go on.
bool PressProcedure::watch(const PressTick& tick) {
  if (tick.fresh) {
    last_fresh_ = tick.time;
    if (std::isnan(first_raw_)) first_raw_ = tick.force;
    varies_ = varies_ || tick.force != first_raw_;
  } else if (tick.time - last_fresh_ > kStale) {
    fail(
        fmt::format("the force sensor has said nothing for {:.0f} ms; look after its cable and "
                    "[force_sensor]",
                    (tick.time - last_fresh_) / ms));
    return false;
  }
  const double force = tick.force - zero_;
  if (stage_ != Stage::kZero) greatest_ = std::max(greatest_, force);
  if (stage_ != Stage::kZero && force > limits_.most) {
    fail(
        fmt::format("the force sensor says {:.2f} N, more than {:g} N: the wearer presses back, or "
                    "it is wrong",
                    force, limits_.most));
    return false;
  }
  if (duration() > limits_.duration) {
    fail(
        fmt::format("it took longer than {:g} s: the device is too slow, or the wearer does not "
                    "hold still",
                    limits_.duration));
    return false;
  }
  return true;
}

void PressProcedure::advance(const PressTick& tick) {
  if (!failure_.empty() || done()) return;
  if (std::isnan(began_)) {
    began_ = stage_began_ = last_fresh_ = tick.time;
  }
  now_ = tick.time;
  if (!watch(tick)) return;
  if (stage_ != Stage::kZero && tick.fresh) {
    seen_.push_back({advance_of(tick.stands), tick.force - zero_});
    if (seen_.size() > 64) seen_.pop_front();
  }
  switch (stage_) {
    case Stage::kZero:
      zero(tick);
      break;
    case Stage::kMove:
      move();
      break;
    case Stage::kApproach:
      approach(tick);
      break;
    case Stage::kPress:
      press(tick);
      break;
    case Stage::kLeave:
      leave();
      break;
    case Stage::kSettle:
      settle();
      break;
    case Stage::kDone:
      break;
  }
}

void PressProcedure::zero(const PressTick& tick) {
  if (now_ - stage_began_ < kStandTime) return;
  if (tick.fresh) zeros_.push_back(tick.force);
  zero_readings_ += tick.readings;
  const double taken = now_ - stage_began_ - kStandTime;
  if (taken < kZeroTime) return;
  const auto count = static_cast<double>(zeros_.size());
  // The first tick's readings came before.
  if (zeros_.size() < 4 || zero_readings_ < kLeastReadings * taken) {
    fail(
        fmt::format("the force sensor is too slow: {:.0f} readings a second, at least {:g} are "
                    "needed",
                    zero_readings_ / taken, kLeastReadings));
    return;
  }
  for (const double force : zeros_) zero_ += force / count;
  double square = 0.0;
  for (const double force : zeros_) square += (force - zero_) * (force - zero_);
  noise_ = std::sqrt(square / (count - 1.0));
  if (noise_ > kMostNoise) {
    fail(
        fmt::format("the force sensor is too noisy: {:.2f} N off the skin, standard deviation; at "
                    "most {:g} N",
                    noise_, kMostNoise));
    return;
  }
  begin_press();
}

void PressProcedure::begin_press() {
  const bool first = index_ == 0 && tried_ == 0;
  // Nothing is known of the wearer before the first: from home.
  start_ = first ? std::min(0.0, expected_touch() - clear_) : expected_touch() - clear_;
  advance_ = start_;
  seen_.clear();
  record_ = {.start = at(start_), .readings = {}};
  stage_ = Stage::kMove;
  stage_began_ = now_;
}

void PressProcedure::move() {
  if (seen_.size() >= 2 && recent(2) > std::max(2.0 * limits_.touch, 4.0 * noise_)) {
    // The skin is nearer there than was thought.
    clear_ += kClearer;
    if (++tried_ > kTries) {
      fail("the skin is touched wherever a press would begin: the wearer does not hold still");
      return;
    }
    stage_ = Stage::kLeave;
    return;
  }
  if (!go(at(start_), kMoveSpeed)) {
    stage_began_ = now_;
    return;
  }
  // What comes late is of the way.
  if (now_ - stage_began_ < kSteadyTicks * tick_) return;
  stage_ = Stage::kApproach;
  seen_.clear();
}

void PressProcedure::approach(const PressTick& tick) {
  const double stands = advance_of(tick.stands);
  const double force = recent(kRecent);
  const double noise = noise_ / std::sqrt(static_cast<double>(kRecent));
  if (seen_.size() >= kRecent && force > std::max(limits_.touch, 3.0 * noise)) {
    touched_ = best_at_ = stands;
    best_ = force;
    pressing_ticks_ = 0;
    stage_ = Stage::kPress;
    press(tick);
    return;
  }
  if (seen_.size() >= kRecent && force < -std::max(kReversed, 4.0 * noise)) {
    fail(
        fmt::format("the force sensor is reversed: it says {:.2f} N where the skin is pressed; "
                    "turn the sign of scale_N",
                    force));
    return;
  }
  const double past = stands - expected_touch();
  // A sensor that has said the same number all the time may be none.
  if (past > limits_.without_growth + (varies_ && index_ == 0 ? kBeyond : 0.0)) {
    fail(varies_
             ? fmt::format("no force within {:.1f} mm past where the skin should be: the device is "
                           "off the finger, the wearer pulls away, or the force sensor is stuck",
                           past / mm)
             : fmt::format(
                   "the force sensor is dead or stuck: it has said {:g} N all the time, {:.1f} "
                   "mm past where the skin should be as well",
                   first_raw_ + 0.0, past / mm));
    return;
  }
  if (advance_ >= planned().most) {
    fail(
        fmt::format("the device cannot be advanced any further, {:.1f} mm past where the skin "
                    "should be: it is off the finger, or mounted too far from it",
                    past / mm));
    return;
  }
  advance_ = std::min(advance_ + limits_.approach * tick_, planned().most);
  wanted_ = at(advance_);
}

void PressProcedure::press(const PressTick& tick) {
  const double stands = advance_of(tick.stands);
  const double force = tick.force - zero_;
  ++pressing_ticks_;
  if (tick.fresh && pressing_ticks_ > kSteadyTicks) {
    record_.readings.push_back({tick.stands, force, 1.0});
  }
  const Trend now = trend();
  const double mean = recent(kRecent);
  if (mean > best_ + kGrowth) {
    best_ = mean;
    best_at_ = stands;
  }
  const double ahead = now.slope * limits_.press * kDelayTicks * tick_;
  if (force >= limits_.guard || now.force + ahead >= limits_.guard) {
    end_press();
    return;
  }
  if (mean < kLostPart * best_ - 3.0 * noise_ && best_ > 3.0 * limits_.touch) {
    fail(
        fmt::format("the force falls from {:.2f} to {:.2f} N as the device advances: the wearer "
                    "pulls away",
                    best_, mean));
    return;
  }
  if (stands - best_at_ > limits_.without_growth) {
    fail(
        fmt::format("the force stays at {:.2f} N for {:.1f} mm of advance: the wearer pulls away, "
                    "or the force sensor is stuck",
                    mean, (stands - best_at_) / mm));
    return;
  }
  if (advance_ >= planned().most) {
    if (mean >= kLightest * limits_.guard) {
      end_press();
      return;
    }
    fail(
        fmt::format("the device cannot press harder than {:.2f} N here: it is mounted too far from "
                    "the finger",
                    mean));
    return;
  }
  const double speed =
      ahead > kMostGrowth ? std::max(kMostGrowth / ahead, kSlowest) * limits_.press : limits_.press;
  advance_ = std::min(advance_ + speed * tick_, planned().most);
  wanted_ = at(advance_);
}

void PressProcedure::end_press() {
  if (record_.readings.size() < kLeastOfPress) {
    if (++tried_ > kTries) {
      fail(fmt::format("the force grows to {:g} N within {} readings: the wearer presses back",
                       limits_.guard, record_.readings.size()));
      return;
    }
    record_.readings.clear();
  }
  stage_ = Stage::kLeave;
  stage_began_ = now_;
  leave();
}

void PressProcedure::leave() {
  const double back = std::min(start_, expected_touch() - clear_);
  if (!go(at(back), kLeaveSpeed)) return;
  stage_ = Stage::kSettle;
  stage_began_ = now_;
  seen_.clear();
}

void PressProcedure::settle() {
  if (seen_.size() < static_cast<std::size_t>(kSettleTicks)) return;
  const double left = recent(2);
  if (std::abs(left) > std::max(kLeftOver, 4.0 * noise_)) {
    fail(left > 0.0
             ? fmt::format(
                   "{:.2f} N remain although the device has left the skin: the wearer presses "
                   "back, or the force sensor is stuck",
                   left)
             : fmt::format("the force sensor says {:.2f} N off the skin: it drifts", left));
    return;
  }
  if (record_.readings.empty()) {
    begin_press();
    return;
  }
  const double off = touched_ - planned().touch;
  ++offsets_;
  offset_ += (off - offset_) / offsets_;
  records_.push_back(std::move(record_));
  next_press();
}

void PressProcedure::next_press() {
  tried_ = 0;
  ++index_;
  // Corners give way to what must not be missed.
  const auto left = [&] {
    std::size_t needed = 0;
    for (std::size_t i = index_; i < plan_.size(); ++i) needed += plan_[i].spare ? 0U : 1U;
    return needed;
  };
  while (index_ < plan_.size() && plan_[index_].spare &&
         duration() + kOnePress * static_cast<double>(left() + 1) > limits_.duration) {
    ++index_;
  }
  if (index_ < plan_.size()) {
    begin_press();
    return;
  }
  stage_ = Stage::kDone;
  wanted_ = device_.home();
}

}  // namespace softfinger
