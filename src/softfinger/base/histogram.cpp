#include "softfinger/base/histogram.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {
namespace {

constexpr double kRatio = 1.02;

int bucket_of(double seconds) {
  if (!(seconds >= Histogram::kMin)) return 0;
  if (seconds >= Histogram::kMax) return Histogram::kBuckets - 1;
  static const double kInverseLogRatio = 1.0 / std::log(kRatio);
  const int bucket = 1 + static_cast<int>(std::log(seconds / Histogram::kMin) * kInverseLogRatio);
  return std::min(bucket, Histogram::kBuckets - 2);
}

}  // namespace

void Histogram::add(double seconds) {
  ++buckets_[static_cast<std::size_t>(bucket_of(seconds))];
  ++count_;
  if (seconds > 0.0) {
    max_ = std::max(max_, seconds);
    sum_ += seconds;
  }
}

void Histogram::merge(const Histogram& other) {
  for (std::size_t i = 0; i < buckets_.size(); ++i) buckets_[i] += other.buckets_[i];
  count_ += other.count_;
  max_ = std::max(max_, other.max_);
  sum_ += other.sum_;
}

void Histogram::clear() { *this = Histogram(); }

double Histogram::upper_edge(int bucket) { return kMin * std::pow(kRatio, bucket); }

double Histogram::percentile(double percent) const {
  if (count_ == 0) return 0.0;
  const double share = std::clamp(percent, 0.0, 100.0) / 100.0;
  const auto rank = std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_))));
  std::uint64_t below = 0;
  for (int bucket = 0; bucket < kBuckets - 1; ++bucket) {
    below += buckets_[static_cast<std::size_t>(bucket)];
    // The middle of the bucket, on its logarithmic scale.
    if (below >= rank) return std::min(max_, upper_edge(bucket) / std::sqrt(kRatio));
  }
  return max_;
}

}  // namespace softfinger
