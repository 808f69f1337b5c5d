#pragma once

#include <cstdint>

namespace softfinger {

/// Ties steps to the wall clock by absolute times, so that lateness of one step does not add up.
/// One thread.
class StepPacer {
 public:
  /// rate in Hz.
  explicit StepPacer(double rate);

  /// The next step to be finished is `step`; its time begins now.
  void restart(std::int64_t step);
  /// Sleeps until the time of `step`, just finished, is over; where it is over already only a
  /// moment, ten times a second, so that a run that is late for long leaves others some time.
  void wait(std::int64_t step);
  /// Steps that were not finished when their time was over.
  [[nodiscard]] std::uint64_t misses() const { return misses_; }

 private:
  double period_;
  std::int64_t first_ = 1;
  double origin_ = 0.0;  ///< when `first_` began, s on the monotonic clock
  double slept_ = 0.0;   ///< when it slept last, s on the monotonic clock
  std::uint64_t misses_ = 0;
};

}  // namespace softfinger
