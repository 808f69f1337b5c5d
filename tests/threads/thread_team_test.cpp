#include "softfinger/threads/thread_team.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <numeric>
#include <thread>
#include <vector>

#include "softfinger/threads/spin_until.hpp"

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

TEST(ThreadTeam, ACallMayWaitForEarlierOnes) {
  for (const int threads : {1, 2, 4}) {
    ThreadTeam team(threads);
    for (int repetition = 0; repetition < 500; ++repetition) {
      std::atomic<std::size_t> finished{0};
      team.run(40, [&](std::size_t i, int) {
        spin_until([&] { return finished.load() == i; });
        finished.store(i + 1);
      });
      EXPECT_EQ(finished.load(), 40U);
    }
  }
}

TEST(ThreadTeam, ShortJobsDoNotRunIntoEachOther) {
  // Of different lengths, so that who comes late to one could take too much of it.
  ThreadTeam team(4);
  for (std::size_t job = 0; job < 100000; ++job) {
    const std::size_t count = 2 + job % 5;
    std::atomic<std::size_t> calls{0};
    team.run(count, [&](std::size_t i, int) {
      EXPECT_LT(i, count);
      calls.fetch_add(1, std::memory_order_relaxed);
    });
    ASSERT_EQ(calls.load(), count) << job;
  }
}

TEST(ThreadTeam, BothEndsMeet) {
  for (const int threads : {1, 2, 4}) {
    ThreadTeam team(threads);
    for (ThreadTeam* shared : {&team, static_cast<ThreadTeam*>(nullptr)}) {
      for (int repetition = 0; repetition < 200; ++repetition) {
        std::vector<int> times(9, 0);
        share_from_both_ends(shared, times.size(), [&](std::size_t i, int) { ++times[i]; });
        EXPECT_EQ(times, std::vector<int>(9, 1));
      }
    }
  }
}

TEST(ThreadTeam, EveryHelperIsToldFirst) {
  std::atomic<int> told{0};
  {
    const ThreadTeam team(3, [&] { told.fetch_add(1); });
  }
  EXPECT_EQ(told.load(), 2);
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
