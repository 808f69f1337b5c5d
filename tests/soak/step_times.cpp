#include "step_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {

void StepTimes::note() noexcept {
  const std::size_t count = count_.load(std::memory_order_relaxed);
  if (count == times_.size()) return;
  times_[count] = monotonic_time();
  count_.store(count + 1, std::memory_order_release);
}

double StepTimes::rate() const {
  const auto all = times();
  if (all.size() < 2) return 0.0;
  return static_cast<double>(all.size() - 1) / (all.back() - all.front());
}

std::vector<double> StepTimes::lateness(double period) const {
  std::vector<double> late;
  double least = std::numeric_limits<double>::infinity();
  for (const double time : times()) {
    late.push_back(time - period * static_cast<double>(late.size()));
    least = std::min(least, late.back());
  }
  for (double& one : late) one -= least;
  return late;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto last = static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::ceil(share * last));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::string quantiles_ms(const std::vector<double>& values) {
  return fmt::format("p50 {:.3f}  p99 {:.3f}  p99.9 {:.3f}  max {:.3f} ms",
                     1e3 * quantile(values, 0.5), 1e3 * quantile(values, 0.99),
                     1e3 * quantile(values, 0.999), 1e3 * quantile(values, 1.0));
}

std::string histogram_ms(const std::vector<double>& values, const std::string& indent) {
  constexpr std::array<double, 10> kEdges = {0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 1e9};
  constexpr double kWidth = 40.0;  // characters of a bar, each decade of the count a fifth
  std::string lines;
  double from = 0.0;
  for (const double to : kEdges) {
    const auto count = std::ranges::count_if(
        values, [&](double value) { return 1e3 * value >= from && 1e3 * value < to; });
    const double bar =
        count > 0 ? kWidth * (std::log10(static_cast<double>(count)) + 1.0) / 6.0 : 0;
    const std::string span =
        to < 1e9 ? fmt::format("{:g} to {:g} ms", from, to) : fmt::format("over {:g} ms", from);
    lines += fmt::format("{}{:>14} {:>8} {}\n", indent, span, count,
                         std::string(static_cast<std::size_t>(bar), '#'));
    from = to;
  }
  return lines;
}

}  // namespace softfinger
