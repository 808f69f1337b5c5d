#include "softfinger/wearer/touch_procedure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/wearer/advance.hpp"

namespace softfinger {
namespace {

constexpr double kWaySpeed = 30.0 * mm;  // a second, of the surface
constexpr double kRetreatSpeed = 25.0 * mm;
constexpr double kAir = 0.5 * mm;         // off the skin, where a touch begins, and
constexpr double kAirDeviations = 2.0;    // of where it is expected
constexpr double kQuietTime = 0.3;        // s, there: what is felt of the way there is over
constexpr double kFurtherOff = 0.8 * mm;  // more, after one that began on the skin
constexpr std::size_t kMostTries = 2;
constexpr double kBlocked = 1.5 * mm;  // a limit keeps the device from where it is sent

}  // namespace

TouchProcedure::TouchProcedure(const Device& device, std::vector<PlannedPress> plan, double tick,
                               TouchLimits limits)
    : device_(device),
      plan_(std::move(plan)),
      tick_(tick),
      limits_(limits),
      wanted_(device.home()) {
  begin_touch();
}

void TouchProcedure::fail(std::string why) {
  if (failure_.empty()) failure_ = std::move(why);
  wanted_ = device_.retracted();
}

double TouchProcedure::progress() const {
  return static_cast<double>(touches_.size()) / static_cast<double>(plan_.size());
}

Configuration TouchProcedure::at(double advance) const {
  return advanced(device_, planned().tilted, advance);
}

double TouchProcedure::advance_of(const Configuration& q) const {
  return advance_between(device_, planned().tilted, q);
}

bool TouchProcedure::go(const Configuration& q, double speed) {
  return step_towards(device_, q, speed * tick_, wanted_);
}

void TouchProcedure::begin_touch() {
  const ExpectedTouch::Place skin = expected_.of(planned());
  start_ = skin.touch - kAir - kAirDeviations * skin.deviation - clear_;
  // Nothing is known of the wearer before the first: from home.
  if (index_ == 0) start_ = std::min(start_, 0.0);
  advance_ = start_;
  stage_ = Stage::kMove;
  arrived_ = now_;
}

void TouchProcedure::advance(const TouchTick& tick) {
  if (!failure_.empty() || done()) return;
  if (std::isnan(began_)) began_ = arrived_ = tick.time;
  now_ = tick.time;
  if (duration() > limits_.duration) {
    fail(fmt::format("it took longer than {:g} s: the device is too slow", limits_.duration));
    return;
  }
  switch (stage_) {
    case Stage::kMove:
      move(tick);
      break;
    case Stage::kApproach:
      approach(tick);
      break;
    case Stage::kLeave:
      leave();
      break;
    case Stage::kDone:
      break;
  }
}

void TouchProcedure::move(const TouchTick& tick) {
  if (tick.told) return back_off();
  if (!go(at(start_), kWaySpeed)) {
    arrived_ = now_;
    return;
  }
  if (now_ - arrived_ >= kQuietTime) stage_ = Stage::kApproach;
}

void TouchProcedure::back_off() {
  if (++tried_ > kMostTries) {
    fail("a touch is told wherever one would begin: say so when the device comes, not before");
    return;
  }
  clear_ += kFurtherOff;
  begin_touch();
}

void TouchProcedure::approach(const TouchTick& tick) {
  const double stands = advance_of(tick.stands);
  const ExpectedTouch::Place skin = expected_.of(planned());
  if (tick.told) {
    const double felt = stands - limits_.reaction * limits_.approach;
    if (felt <= start_) return back_off();
    expected_.learn(planned(), felt);
    touches_.push_back({at(start_), felt - start_});
    stage_ = Stage::kLeave;
    leave();
    return;
  }
  if (stands > skin.touch + limits_.past) {
    fail(
        fmt::format("no touch was told within {:.1f} mm past where the skin should be: the device "
                    "is off the finger, or it was felt and not told",
                    limits_.past / mm));
    return;
  }
  if (advance_ >= planned().most || advance_ - stands > kBlocked) {
    fail(
        "a limit of the device ends before the skin is felt: it is off the finger, or mounted too "
        "far from it");
    return;
  }
  advance_ = std::min(advance_ + limits_.approach * tick_, planned().most);
  wanted_ = at(advance_);
}

void TouchProcedure::leave() {
  if (go(at(start_), kRetreatSpeed)) next_touch();
}

void TouchProcedure::next_touch() {
  if (index_ + 1 < plan_.size()) {
    ++index_;
    tried_ = 0;
    begin_touch();
    return;
  }
  stage_ = Stage::kDone;
  wanted_ = device_.home();
}

}  // namespace softfinger
