#include "softfinger/base/histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace softfinger {
namespace {

TEST(Histogram, EmptyIsZero) {
  const Histogram histogram;
  EXPECT_EQ(histogram.count(), 0u);
  EXPECT_EQ(histogram.max(), 0.0);
  EXPECT_EQ(histogram.percentile(50.0), 0.0);
}

TEST(Histogram, PercentilesAreWithinTwoPercentOfSorting) {
  std::mt19937 random(1);
  std::lognormal_distribution<double> times(std::log(3e-4), 1.5);
  Histogram histogram;
  std::vector<double> sorted;
  for (int i = 0; i < 20000; ++i) {
    const double time = times(random);
    histogram.add(time);
    sorted.push_back(time);
  }
  std::sort(sorted.begin(), sorted.end());
  for (const double percent : {1.0, 50.0, 90.0, 99.0, 99.9}) {
    const auto rank = static_cast<std::size_t>(std::ceil(percent / 100.0 * 20000.0)) - 1;
    EXPECT_NEAR(histogram.percentile(percent) / sorted[rank], 1.0, 0.02) << percent;
  }
  EXPECT_EQ(histogram.max(), sorted.back());
  EXPECT_LE(histogram.percentile(100.0), histogram.max());
}

TEST(Histogram, CoversItsSpanAndBeyond) {
  for (double time = 1.01e-7; time < 9.9; time *= 1.7) {
    Histogram histogram;
    histogram.add(time);
    histogram.add(100.0);
    EXPECT_NEAR(histogram.percentile(50.0) / time, 1.0, 0.02) << time;
    EXPECT_EQ(histogram.percentile(100.0), 100.0);
  }
  EXPECT_GE(Histogram::upper_edge(Histogram::kBuckets - 2), Histogram::kMax);
  Histogram odd;
  odd.add(0.0);
  odd.add(-1.0);
  odd.add(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(odd.count(), 3u);
  EXPECT_EQ(odd.percentile(99.0), 0.0);
}

TEST(Histogram, MergeIsAddingAll) {
  Histogram first, second, all;
  for (int i = 1; i <= 100; ++i) {
    (i % 3 == 0 ? first : second).add(1e-5 * i);
    all.add(1e-5 * i);
  }
  first.merge(second);
  EXPECT_EQ(first.count(), all.count());
  EXPECT_EQ(first.max(), all.max());
  for (int bucket = 0; bucket < Histogram::kBuckets; ++bucket) {
    EXPECT_EQ(first.bucket_count(bucket), all.bucket_count(bucket));
  }
}

}  // namespace
}  // namespace softfinger
