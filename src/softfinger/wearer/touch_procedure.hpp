#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "softfinger/device/device.hpp"
#include "softfinger/wearer/expected_touch.hpp"
#include "softfinger/wearer/press_plan.hpp"
#include "softfinger/wearer/press_reading.hpp"

namespace softfinger {

/// What is known after one device tick.
struct TouchTick {
  double time = 0.0;     ///< s
  Configuration stands;  ///< where the device is
  bool told = false;     ///< the wearer has said since the last tick that it is felt
};

struct TouchLimits {
  double approach = 1e-3;  ///< m/s
  double past = 1.2e-3;    ///< m past where the skin should be that it is looked for
  /// From a touch to the wearer's word, s. A simple reaction to touch takes 0.155 s (Robinson 1934,
  /// as Kosinski, "A Literature Review on Reaction Time", reports it; not verified); who waits for
  /// something that grows slowly takes a little more.
  double reaction = 0.2;
  double duration = 90.0;  ///< s, of all
};

/// Touches by itself, without a force sensor: from tilt to tilt, nears the skin slowly until the
/// wearer says that it is felt, leaves. No input or output, as PressProcedure. Whoever leads the
/// device retracts it when it is done and when it fails.
class TouchProcedure {
 public:
  /// `tick`: of the device, s.
  TouchProcedure(const Device& device, std::vector<PlannedPress> plan, double tick,
                 TouchLimits limits = {});

  /// Where the device is to go.
  [[nodiscard]] const Configuration& wanted() const { return wanted_; }
  /// One tick has passed with that.
  void advance(const TouchTick& tick);

  [[nodiscard]] bool done() const { return stage_ == Stage::kDone; }
  /// The touch under way; null: all is over.
  [[nodiscard]] const PlannedPress* under_way() const { return done() ? nullptr : &planned(); }
  /// Which of all that is, from 0.
  [[nodiscard]] std::size_t number() const { return index_; }
  /// Why it ended, in one line; empty while it has not failed.
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// 0 to 1.
  [[nodiscard]] double progress() const;

  /// Those that are done, with the reaction taken off.
  [[nodiscard]] const std::vector<TouchRecord>& touches() const { return touches_; }
  [[nodiscard]] double duration() const { return now_ - began_; }

 private:
  enum class Stage : std::uint8_t { kMove, kApproach, kLeave, kDone };

  void fail(std::string why);
  void begin_touch();
  void move(const TouchTick& tick);
  /// It is felt where a touch would begin.
  void back_off();
  void approach(const TouchTick& tick);
  void leave();
  void next_touch();
  /// Moves `wanted_` towards q with this speed of the surface, m/s; true where it is there.
  bool go(const Configuration& q, double speed);
  [[nodiscard]] Configuration at(double advance) const;
  [[nodiscard]] double advance_of(const Configuration& q) const;
  [[nodiscard]] const PlannedPress& planned() const { return plan_[index_]; }

  const Device& device_;
  std::vector<PlannedPress> plan_;
  double tick_;
  TouchLimits limits_;
  Configuration wanted_;
  Stage stage_ = Stage::kMove;
  std::string failure_;
  double began_ = std::numeric_limits<double>::quiet_NaN();
  double now_ = 0.0;
  double arrived_ = 0.0;  ///< s, where the touch under way begins
  std::size_t index_ = 0;
  std::size_t tried_ = 0;               ///< the touch under way, in vain
  double clear_ = 0.0;                  ///< how much further off the skin touches begin, m
  double start_ = 0.0, advance_ = 0.0;  ///< of the touch under way, m
  ExpectedTouch expected_;
  std::vector<TouchRecord> touches_;
};

}  // namespace softfinger
