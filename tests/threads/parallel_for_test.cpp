#include "softfinger/threads/parallel_for.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace softfinger {
namespace {

TEST(ParallelFor, DoesEachOnce) {
  for (const std::size_t count : {0u, 1u, 2u, 1000u}) {
    std::vector<std::atomic<int>> done(count);
    parallel_for(count, [&](std::size_t i) { ++done[i]; });
    for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1);
  }
}

TEST(ParallelFor, ProgressRisesOnTheThreadThatAsked) {
  const std::thread::id me = std::this_thread::get_id();
  std::vector<double> told;
  parallel_for(
      500, [](std::size_t) {},
      [&](double part) {
        EXPECT_EQ(std::this_thread::get_id(), me);
        told.push_back(part);
      });
  for (const double part : told) EXPECT_TRUE(part >= 0.0 && part <= 1.0) << part;
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
}

TEST(ParallelFor, AnExceptionEndsItAndArrives) {
  std::atomic<int> begun = 0;
  EXPECT_THROW(parallel_for(5000,
                            [&](std::size_t i) {
                              ++begun;
                              if (i == 3) throw std::runtime_error("enough");
                              std::this_thread::sleep_for(std::chrono::milliseconds(1));
                            }),
               std::runtime_error);
  EXPECT_LT(begun, 5000);
}

}  // namespace
}  // namespace softfinger
