#include "softfinger/base/thread_team.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <numeric>

namespace softfinger {
namespace {

TEST(ThreadTeam, DoesEverythingOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    ThreadTeam team(threads);
    EXPECT_EQ(team.threads(), threads);
    for (int repetition = 0; repetition < 200; ++repetition) {
      for (const std::size_t count : {0U, 1U, 2U, 7U, 100U}) {
        std::vector<int> times(count, 0);
        team.run(count, [&](std::size_t i, int thread) {
          EXPECT_GE(thread, 0);
          EXPECT_LT(thread, threads);
          ++times[i];
        });
        EXPECT_EQ(times, std::vector<int>(count, 1));
      }
    }
  }
}

TEST(ThreadTeam, AJobSeesWhatTheOneBeforeWrote) {
  ThreadTeam team(3);
  std::vector<long> values(64);
  std::iota(values.begin(), values.end(), 0L);
  for (int round = 0; round < 5000; ++round) {
    std::vector<long> next(values.size());
    team.run(values.size(), [&](std::size_t i, int) { next[i] = values[(i + 1) % values.size()]; });
    values.swap(next);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(values[i], static_cast<long>((i + 5000) % values.size()));
  }
}

TEST(ThreadTeam, SleepingHelpersWake) {
  ThreadTeam team(2);
  for (int repetition = 0; repetition < 20; ++repetition) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::atomic<int> together{0};
    // Ends only when both are at work at once.
    team.run(2, [&](std::size_t, int) {
      together.fetch_add(1);
      while (together.load() < 2) std::this_thread::yield();
    });
    EXPECT_EQ(together.load(), 2);
  }
}

}  // namespace
}  // namespace softfinger
