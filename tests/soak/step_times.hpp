#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace softfinger {

/// When the steps of a run were over, wall time. One thread notes; others ask after it has ended.
class StepTimes {
 public:
  explicit StepTimes(std::size_t most) : times_(most) {}

  /// The next step is over now. Allocates nothing, takes no lock.
  void note() noexcept;
  /// Of each step from the first, s on the monotonic clock.
  [[nodiscard]] std::span<const double> times() const {
    return std::span(times_).first(count_.load(std::memory_order_acquire));
  }
  /// Steps a second, from the first to the last.
  [[nodiscard]] double rate() const;
  /// How much later each step came than `period` (s) times its number after the most punctual one,
  /// s.
  [[nodiscard]] std::vector<double> lateness(double period) const;

 private:
  std::vector<double> times_;
  std::atomic<std::size_t> count_{0};
};

/// The value that a share of `values` does not exceed; 0 where there are none.
[[nodiscard]] double quantile(std::vector<double> values, double share);
/// "p50 0.004  p99 0.02  p99.9 0.1  max 0.4 ms", of s.
[[nodiscard]] std::string quantiles_ms(const std::vector<double>& values);
/// Lines of a histogram with edges from 0.05 to 20 ms; each line begins with `indent`.
[[nodiscard]] std::string histogram_ms(const std::vector<double>& values,
                                       const std::string& indent);

}  // namespace softfinger
