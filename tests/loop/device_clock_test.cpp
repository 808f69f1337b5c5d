#include "softfinger/loop/device_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace softfinger {
namespace {

std::vector<std::int64_t> ticking_steps(double simulation_rate, double rate, std::int64_t steps) {
  DeviceClock clock(simulation_rate, rate);
  std::vector<std::int64_t> ticking;
  for (std::int64_t step = 1; step <= steps; ++step) {
    if (clock.ticks(step)) ticking.push_back(step);
  }
  return ticking;
}

TEST(DeviceClock, TickFallsInTheFirstStepAtOrAfterItsTime) {
  const std::vector<std::int64_t> steps = ticking_steps(1000.0, 30.0, 8000);
  ASSERT_EQ(steps.size(), 241u);  // 0, 1/30, ..., 8
  EXPECT_EQ(steps[0], 1) << "tick 0 falls in the first step";
  for (std::size_t k = 1; k < steps.size(); ++k) {
    // First n with n / 1000 >= k / 30, in whole numbers.
    EXPECT_EQ(steps[k], (static_cast<std::int64_t>(k) * 1000 + 29) / 30);
  }
}

TEST(DeviceClock, EqualRatesTickInEveryStep) {
  EXPECT_EQ(ticking_steps(1000.0, 1000.0, 500).size(), 500u);
}

TEST(DeviceClock, FasterDeviceTicksOnceAStep) {
  EXPECT_EQ(ticking_steps(60.0, 500.0, 120).size(), 120u);
}

TEST(DeviceClock, NoDriftOverAnHour) {
  const std::vector<std::int64_t> steps = ticking_steps(1000.0, 30.0, 3'600'000);
  EXPECT_EQ(steps.size(), 108'001u);
  EXPECT_EQ(steps.back(), 3'600'000);
}

}  // namespace
}  // namespace softfinger
