#include "softfinger/wearer/press_procedure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/wearer/advance.hpp"

namespace softfinger {
namespace {

constexpr double kZeroTime = 0.5;          // s, off the skin
constexpr double kStandTime = 0.2;         // s, before that: the device comes to rest
constexpr double kLeastReadings = 20.0;    // a second
constexpr double kMostNoise = 0.15;        // N, standard deviation
constexpr double kStale = 0.25;            // s
constexpr double kLeaveSpeed = 25.0 * mm;  // a second
constexpr double kMoveSpeed = 30.0 * mm;   // a second, of the surface
constexpr double kClear = 0.5 * mm;        // off the skin, where a press begins, and
constexpr double kClearDeviations = 1.3;   // of where it is expected
constexpr double kOff = 1.0 * mm;          // behind where a touch was noticed
constexpr double kClearer = 0.8 * mm;      // more, after a press that began on the skin
constexpr double kHeldBack = 1.5 * mm;     // a limit keeps the device from where it is sent
/// Readings in a row that are the same, beyond twice as many as there were off the skin.
constexpr std::size_t kStuck = 5;
constexpr double kGrowth = 0.05;        // N, that counts as growth
constexpr double kReversed = 0.1;       // N
constexpr double kReversedNoise = 2.5;  // deviations of one reading, of the mean of kRecent
constexpr double kLostPart = 0.5;       // of the greatest force of a press
constexpr double kNoTouchNoise = 3.3;   // deviations of the noise of a mean
constexpr double kSurely = 1.5;         // of the threshold: no noise
constexpr double kNoTouch = 0.4 * mm;   // of advance, in which a touch must show
constexpr double kLeftOver = 0.12;      // N, off the skin
constexpr std::size_t kSettleReadings = 4;
constexpr int kDelayTicks = 3;            // until a force that is too large ends
constexpr int kSteadyTicks = 3;           // after a change of speed
constexpr double kMostGrowth = 0.15;      // N, that may come within the delay
constexpr double kStraightGrowth = 0.08;  // N, the same straight on
constexpr double kSlowest = 0.4;          // of the speed of a press
constexpr std::size_t kLeastOfPress = 5;  // readings
constexpr std::size_t kTries = 2;
constexpr std::size_t kRecent = 4;   // readings that are averaged
constexpr std::size_t kSoonest = 2;  // the same where the force grows fast
constexpr std::size_t kTrend = 8;
constexpr std::size_t kLeastPresses = 5;  // of nine
constexpr double kOnePress = 2.2;         // s, with the way there
constexpr double kOneStraight = 3.2;      // s, the same of a slower one
constexpr double kLightest = 0.5;         // of the guard, that each press must have come to
constexpr double kQuietEnough = 0.05;     // N, of noise, standard deviation
constexpr double kGuardByNoise = 2.0;    // N a N of noise beyond that, by which presses end earlier
constexpr std::size_t kLate = 2;         // readings after the device has left the skin
constexpr double kSurelyOff = 0.4 * mm;  // before a touch is noticed: the skin is not touched yet

bool is_straight(const PlannedPress& press) { return press.pitch == 0.0 && press.roll == 0.0; }

}  // namespace

PressProcedure::PressProcedure(const Device& device, std::vector<PlannedPress> plan, double tick,
                               PressLimits limits)
    : device_(device),
      plan_(std::move(plan)),
      tick_(tick),
      limits_(limits),
      wanted_(device.home()) {}

void PressProcedure::fail(std::string why) {
  if (failure_.empty()) failure_ = std::move(why);
  wanted_ = device_.retracted();
}

double PressProcedure::progress() const {
  if (done()) return 1.0;
  return static_cast<double>(records_.size()) / static_cast<double>(plan_.size());
}

Configuration PressProcedure::at(double advance) const {
  return advanced(device_, planned().tilted, advance);
}

double PressProcedure::advance_of(const Configuration& q) const {
  return advance_between(device_, planned().tilted, q);
}

bool PressProcedure::go(const Configuration& q, double speed) {
  return step_towards(device_, q, speed * tick_, wanted_);
}

double PressProcedure::recent(std::size_t count) const {
  const std::size_t taken = std::min(count, seen_.size());
  if (taken == 0) return 0.0;
  double sum = 0.0;
  for (std::size_t i = seen_.size() - taken; i < seen_.size(); ++i) sum += seen_[i].force;
  return sum / static_cast<double>(taken);
}

double PressProcedure::touch_threshold(std::size_t count) const {
  return std::max(limits_.touch, kNoTouchNoise * noise_ / std::sqrt(static_cast<double>(count)));
}

double PressProcedure::press_speed() const {
  return is_straight(planned()) ? limits_.straight_press : limits_.press;
}

/// Nearer to zero for a sensor so noisy that it would say too much by itself.
double PressProcedure::guard() const {
  return limits_.guard - kGuardByNoise * std::max(noise_ - kQuietEnough, 0.0);
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
    if (tick.readings > 0) {
      alike_ = tick.force == last_raw_ ? alike_ + 1 : 0;
      last_raw_ = tick.force;
    }
    if (stage_ == Stage::kZero) longest_alike_ = std::max(longest_alike_, alike_);
  } else if (tick.time - last_fresh_ > kStale) {
    fail(
        fmt::format("the force sensor has said nothing for {:.0f} ms; look after its cable and "
                    "[force_sensor]",
                    (tick.time - last_fresh_) / ms));
    return false;
  }
  if (noise_ > 0.0 && alike_ >= kStuck + 2 * longest_alike_) {
    fail(
        fmt::format("the force sensor is dead or stuck: it says {:g} N again and again, and varied "
                    "by {:.3f} N before",
                    tick.force + 0.0, noise_));
    return false;
  }
  const double force = tick.force - zero_;
  if (stage_ != Stage::kZero) greatest_ = std::max(greatest_, force);
  // One reading may be noise.
  const double mean = seen_.empty() ? force : 0.5 * (force + seen_.back().force);
  const bool too_much = force > limits_.most + kNoTouchNoise * noise_ || mean > limits_.most;
  if (stage_ != Stage::kZero && tick.fresh && too_much) {
    fail(
        fmt::format("the force sensor says {:.2f} N, more than {:g} N: the wearer presses back, or "
                    "it is wrong",
                    force, limits_.most));
    return false;
  }
  if (duration() > limits_.duration) {
    if (enough()) {
      finish();
      return false;
    }
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
  const bool leaves = stage_ == Stage::kLeave || stage_ == Stage::kSettle;
  if (leaves && tick.fresh) late_.watch(advance_of(tick.stands), tick.force);
  switch (stage_) {
    case Stage::kZero:
      zero(tick);
      break;
    case Stage::kMove:
      move(tick);
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
      settle(tick);
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
  for (const double force : zeros_) off_skin_.add(force);
  first_zero_ = zero_ = off_skin_.mean();
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

/// Half a second's mean of a noisy sensor is a part of its noise off, which all forces would be as
/// well. By no more than that: what is beyond is something that touches.
void PressProcedure::renew_zero() {
  const double most = kNoTouchNoise * noise_ / std::sqrt(static_cast<double>(zeros_.size()));
  zero_ = std::clamp(off_skin_.mean(), first_zero_ - most, first_zero_ + most);
}

void PressProcedure::begin_press() {
  renew_zero();
  moving_ = {};
  const ExpectedTouch::Place skin = expected_.of(planned());
  start_ = skin.touch - kClear - kClearDeviations * skin.deviation - clear_;
  // Nothing is known of the wearer before the first: from home.
  if (index_ == 0) start_ = std::min(start_, 0.0);
  advance_ = start_;
  touched_ = std::numeric_limits<double>::infinity();
  seen_.clear();
  record_ = {.start = at(start_), .approach = {}, .readings = {}};
  stage_ = Stage::kMove;
  stage_began_ = now_;
}

void PressProcedure::move(const PressTick& tick) {
  const bool touches =
      !seen_.empty() && seen_.back().force > std::max(3.0 * limits_.touch, 5.0 * noise_);
  if (touches || (seen_.size() >= kSoonest && recent(kSoonest) > touch_threshold(1))) {
    // The skin is nearer there than was thought.
    clear_ += kClearer;
    if (++tried_ > kTries) {
      fail("the skin is touched wherever a press would begin: the wearer does not hold still");
      return;
    }
    stage_ = Stage::kLeave;
    return;
  }
  if (tick.fresh) moving_.add(tick.force);
  if (!go(at(start_), kMoveSpeed)) {
    stage_began_ = now_;
    return;
  }
  // What comes late is of the way.
  if (now_ - stage_began_ < kSteadyTicks * tick_) return;
  off_skin_.add(moving_);
  stage_ = Stage::kApproach;
  seen_.clear();
}

void PressProcedure::approach(const PressTick& tick) {
  const double stands = advance_of(tick.stands);
  const double force = recent(kRecent);
  if (seen_.size() >= kRecent &&
      (force > touch_threshold(kRecent) || recent(kSoonest) > touch_threshold(kSoonest))) {
    touched_ = best_at_ = stands;
    best_ = force;
    pressing_ticks_ = 0;
    stage_ = Stage::kPress;
    press(tick);
    return;
  }
  if (tick.fresh) record_.approach.push_back({tick.stands, tick.force, 1.0, tick.time});
  if (seen_.size() >= kRecent && force < -std::max(kReversed, kReversedNoise * noise_)) {
    fail(
        fmt::format("the force sensor is reversed: it says {:.2f} N where the skin is pressed; "
                    "turn the sign of scale_N",
                    force));
    return;
  }
  const double past = stands - expected_.of(planned()).touch;
  // A sensor that says the same number all the time may be none.
  const bool lives = noise_ > 0.0;
  if (past > (lives ? kFurthestPast : limits_.without_life)) {
    fail(lives
             ? fmt::format("no force within {:.1f} mm past where the skin should be: the device is "
                           "off the finger, the wearer pulls away, or the force sensor is stuck",
                           past / mm)
             : fmt::format("the force sensor is dead or stuck: it says {:g} N all the time, {:.1f} "
                           "mm past where the skin should be as well",
                           tick.force + 0.0, past / mm));
    return;
  }
  if (advance_ >= planned().most || advance_ - stands > kHeldBack) {
    give_up_press();
    return;
  }
  // More slowly where that was too fast.
  const double speed = limits_.approach / static_cast<double>(1 + tried_);
  advance_ = std::min(advance_ + speed * tick_, planned().most);
  wanted_ = at(advance_);
}

void PressProcedure::press(const PressTick& tick) {
  const double stands = advance_of(tick.stands);
  const double force = tick.force - zero_;
  ++pressing_ticks_;
  if (tick.fresh) {
    const bool steady = pressing_ticks_ > kSteadyTicks;
    (steady ? record_.readings : record_.approach)
        .push_back({tick.stands, tick.force, 1.0, tick.time});
  }
  const Trend now = trend();
  const double mean = recent(kRecent);
  if (mean > best_ + kGrowth) {
    best_ = mean;
    best_at_ = stands;
  }
  const double ahead = now.slope * press_speed() * kDelayTicks * tick_;
  if (force >= guard() || now.force + ahead >= guard()) {
    end_press();
    return;
  }
  if (best_ < kSurely * touch_threshold(kRecent) && stands - touched_ > kNoTouch &&
      mean < kSurely * touch_threshold(kRecent)) {
    // It was noise.
    record_.approach.insert(record_.approach.end(), record_.readings.begin(),
                            record_.readings.end());
    record_.readings.clear();
    stage_ = Stage::kApproach;
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
  if (advance_ >= planned().most || advance_ - stands > kHeldBack) {
    if (mean >= kLightest * guard()) {
      end_press();
    } else {
      give_up_press();
    }
    return;
  }
  const double most = is_straight(planned()) ? kStraightGrowth : kMostGrowth;
  const double speed =
      ahead > most ? std::max(most / ahead, kSlowest) * press_speed() : press_speed();
  advance_ = std::min(advance_ + speed * tick_, planned().most);
  wanted_ = at(advance_);
}

void PressProcedure::end_press() {
  if (record_.readings.size() < kLeastOfPress) {
    if (++tried_ > kTries) {
      fail(fmt::format("the force grows to {:g} N within {} readings: the wearer presses back",
                       guard(), record_.readings.size()));
      return;
    }
    record_.readings.clear();
  }
  for (const Seen& seen : seen_) {
    if (seen.advance < touched_ - kSurelyOff) off_skin_.add(seen.force + zero_);
  }
  const Trend last = trend();
  late_.leave(last.force, last.slope, seen_.back().advance, press_speed());
  stage_ = Stage::kLeave;
  stage_began_ = now_;
  leave();
}

void PressProcedure::take_zero_off() {
  renew_zero();
  for (PressRecord& record : records_) {
    for (PressReading& reading : record.approach) reading.force -= zero_;
    for (PressReading& reading : record.readings) reading.force -= zero_;
  }
}

/// The device does not get as far: it is looked at in the end whether enough are left.
void PressProcedure::give_up_press() {
  record_.readings.clear();
  given_up_ = true;
  stage_ = Stage::kLeave;
  leave();
}

void PressProcedure::leave() {
  const double back = std::min(start_, touched_ - kOff - clear_);
  if (!go(at(back), kLeaveSpeed)) return;
  stage_ = Stage::kSettle;
  stage_began_ = now_;
  seen_.clear();
}

void PressProcedure::settle(const PressTick& tick) {
  if (tick.fresh && seen_.size() > kLate) off_skin_.add(tick.force);
  if (seen_.size() < kSettleReadings) return;
  // Of the last ones alone: those before came late.
  const double left = recent(kSoonest);
  if (std::abs(left) > std::max(kLeftOver, 4.0 * noise_)) {
    fail(left > 0.0 ? fmt::format("{:.2f} N remain although the device has left the skin: the "
                                  "wearer presses back, or the force sensor is stuck",
                                  left)
                    : fmt::format("the force sensor says {:.2f} N off the skin: it drifts", left));
    return;
  }
  if (given_up_) {
    given_up_ = false;
    next_press();
    return;
  }
  if (record_.readings.empty()) {
    begin_press();
    return;
  }
  late_.keep();
  expected_.learn(planned(), touched_);
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
  const auto time_for = [&](const PlannedPress& press) {
    const double own = is_straight(press) ? kOneStraight : kOnePress;
    return duration() + own + kOnePress * static_cast<double>(left()) <= limits_.duration;
  };
  while (index_ < plan_.size() && plan_[index_].spare && !time_for(plan_[index_])) ++index_;
  // What there is does.
  if (records_.size() >= kLeastPresses && duration() + kOnePress > limits_.duration) {
    index_ = plan_.size();
  }
  if (index_ < plan_.size()) {
    begin_press();
    return;
  }
  if (!enough()) {
    fail(
        fmt::format("the device can press in no more than {} of {} tilts, its limits end before: "
                    "it is off the finger, or mounted too far from it",
                    records_.size(), plan_.size()));
    return;
  }
  finish();
}

bool PressProcedure::enough() const {
  return records_.size() >= std::min(kLeastPresses, plan_.size());
}

void PressProcedure::finish() {
  take_zero_off();
  delay_ = late_.mean(zero_, tick_);
  take_delay_off(delay_, records_);
  stage_ = Stage::kDone;
  wanted_ = device_.home();
}

}  // namespace softfinger
