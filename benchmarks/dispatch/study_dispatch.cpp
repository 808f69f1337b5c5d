// How much of a parallel job's time goes into tasks: tasks that sleep, shared out as those of a
// study are, so that many more ranks than processors can be tried.
//
//     mpirun --oversubscribe -n 64 build/softfinger_study_dispatch 50 20
//
// Milliseconds a task, tasks a rank. Prints ranks, tasks, and the time that the tasks alone take on
// as many ranks over the time that passed.

#include <fmt/core.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>

#include "softfinger/study/ranks.hpp"

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  const double task_ms = argc > 1 ? std::atof(argv[1]) : 50.0;
  const std::size_t each = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 20;
  const std::unique_ptr<softfinger::Ranks> ranks = softfinger::ranks_of_this_job();
  const std::size_t count = each * static_cast<std::size_t>(ranks->size());
  const std::atomic<bool> stop{false};
  std::size_t taken = 0;
  ranks->broadcast("begin");  // who starts late is no part of it
  const auto begin = Clock::now();
  ranks->share(
      count,
      [task_ms](std::size_t task) {
        std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(task_ms));
        return std::to_string(task);
      },
      [&taken](std::size_t, std::string_view) { ++taken; }, stop);
  const double passed = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  if (ranks->rank() != 0) return 0;
  fmt::print("{} ranks, {} of {} tasks of {} ms in {:.0f} ms: {:.1f} %\n", ranks->size(), taken,
             count, task_ms, passed, 100.0 * task_ms * static_cast<double>(each) / passed);
  return taken == count ? 0 : 1;
}
