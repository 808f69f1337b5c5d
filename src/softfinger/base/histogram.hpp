#pragma once

#include <array>
#include <cstdint>

namespace softfinger {

/// Histogram of times with fixed buckets, spaced evenly on a logarithmic scale from 100 ns to 10 s:
/// 2 % wide, so percentiles are within 1 % where times lie in that span. add() allocates nothing.
/// One thread at a time.
class Histogram {
 public:
  static constexpr double kMin = 100e-9;  ///< s
  static constexpr double kMax = 10.0;    ///< s
  static constexpr int kBuckets = 933;    ///< of a ratio of 1.02, and one each for below and above

  /// Counts one time, s. Negative and NaN count as below the span.
  void add(double seconds);
  /// Adds all that `other` counted.
  void merge(const Histogram& other);
  void clear();

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Greatest time added, exactly; 0 when nothing was.
  [[nodiscard]] double max() const { return max_; }
  [[nodiscard]] double mean() const {
    return count_ == 0 ? 0.0 : sum_ / static_cast<double>(count_);
  }
  /// Time (s) that `percent` of the times do not exceed, percent in [0, 100]; 0 when nothing was
  /// added; never above max().
  [[nodiscard]] double percentile(double percent) const;
  [[nodiscard]] std::uint64_t bucket_count(int bucket) const {
    return buckets_[static_cast<std::size_t>(bucket)];
  }
  /// Upper edge of a bucket, s.
  [[nodiscard]] static double upper_edge(int bucket);

 private:
  std::array<std::uint64_t, kBuckets> buckets_{};
  std::uint64_t count_ = 0;
  double max_ = 0.0;
  double sum_ = 0.0;
};

}  // namespace softfinger
