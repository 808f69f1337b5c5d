#pragma once

#include <algorithm>

#include "softfinger/tracking/stream/sender_clock.hpp"

namespace softfinger {

/// Maps the monotonic clock to the run's. Steps come now and then a little late; the most punctual
/// ones tell how the two clocks stand, so that poses which came evenly are even on the run's clock.
class RunClock {
 public:
  /// Each step, before the others: run time `time` (s) begins at `now` on the monotonic clock.
  void step(double time, double now) {
    time_ = time;
    behind_ = clock_.local_time(time, now) - time;
  }
  /// Run time of something that was at `moment` (s, monotonic clock); never after this step's.
  [[nodiscard]] double run_time(double moment) const { return std::min(time_, moment - behind_); }

 private:
  // A run that stood still or fell behind by more than this goes on from there.
  static constexpr double kStandstill = 0.05;  // s
  static constexpr double kWindow = 2.0;       // s
  SenderClock clock_{kWindow, kStandstill};
  double time_ = 0.0;
  double behind_ = 0.0;
};

}  // namespace softfinger
