#include "softfinger/actuation/process_state.hpp"

#include <gtest/gtest.h>

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <thread>

namespace softfinger {
namespace {

/// A process that does one thing until it is killed.
class Child {
 public:
  enum class Does { kWork, kSleep, kEnd };
  explicit Child(Does does, const char* name = "child") : process_(::fork()) {
    if (process_ != 0) return;
    ::prctl(PR_SET_NAME, name);
    while (does == Does::kWork) continue;
    while (does == Does::kSleep) ::pause();
    ::_exit(0);
  }
  ~Child() { end(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  [[nodiscard]] int process() const { return process_; }
  void end() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  [[nodiscard]] bool comes_to_be(ProcessState state) const {
    for (int i = 0; i < 2000; ++i) {
      if (process_state(process_) == state) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

 private:
  int process_;
};

TEST(ProcessState, IsWhatAProcessDoes) {
  Child working(Child::Does::kWork);
  Child sleeping(Child::Does::kSleep);
  const Child ended(Child::Does::kEnd);
  EXPECT_TRUE(working.comes_to_be(ProcessState::kRunning));
  EXPECT_TRUE(sleeping.comes_to_be(ProcessState::kAsleep));
  EXPECT_TRUE(ended.comes_to_be(ProcessState::kGone)) << "though nobody has waited for it";
  ::kill(sleeping.process(), SIGSTOP);
  EXPECT_TRUE(sleeping.comes_to_be(ProcessState::kStopped));
  ::kill(sleeping.process(), SIGCONT);
  EXPECT_TRUE(sleeping.comes_to_be(ProcessState::kAsleep));
  working.end();
  EXPECT_EQ(process_state(working.process()), ProcessState::kGone);
}

TEST(ProcessState, WhateverItsNameSays) {
  for (const char* name : {"a) R b", ") T ", "(((", ")))) D", ""}) {
    const Child sleeping(Child::Does::kSleep, name);
    EXPECT_TRUE(sleeping.comes_to_be(ProcessState::kAsleep)) << name;
  }
}

TEST(ProcessState, NoProcessIsGone) {
  EXPECT_EQ(process_state(-1), ProcessState::kGone);
  EXPECT_EQ(process_state(2147483647), ProcessState::kGone);
}

TEST(ProcessCpuTime, GrowsWhileAProcessWorks) {
  Child working(Child::Does::kWork);
  const Child sleeping(Child::Does::kSleep);
  double used = 0.0;
  for (int i = 0; i < 2000 && used < 0.05; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    used = process_cpu_time(working.process());
  }
  EXPECT_GE(used, 0.05);
  EXPECT_LT(process_cpu_time(sleeping.process()), used);
  working.end();
  EXPECT_EQ(process_cpu_time(working.process()), 0.0) << "it is gone";
}

TEST(ProcessCpuTime, IsThatOfTheProcessorsClock) {
  const auto own = [] {
    timespec used{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
  };
  while (own() < 0.01) continue;
  for (int i = 0; i < 100; ++i) {
    const double before = own();
    const double used = process_cpu_time(::getpid());
    EXPECT_GE(used, before);
    EXPECT_LE(used, own());
  }
}

}  // namespace
}  // namespace softfinger
