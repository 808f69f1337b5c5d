// How much of a parallel job's time goes into tasks: tasks that sleep, shared out as those of a
// study are, so that many more ranks than processors can be tried.
//
//     mpirun --oversubscribe -n 64 build/softfinger_study_dispatch 50 20
//
// Milliseconds a task, then tasks a rank, as often as they are to be shared out. Prints ranks,
// tasks, and the time that the tasks alone take on as many ranks over the time that passed.

#include <fmt/core.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>

#include "softfinger/study/ranks.hpp"

namespace {

/// Whether all tasks were done.
bool share_out(softfinger::Ranks& ranks, double task_ms, std::size_t each) {
  using Clock = std::chrono::steady_clock;
  const std::size_t count = each * static_cast<std::size_t>(ranks.size());
  const std::atomic<bool> stop{false};
  std::size_t taken = 0;
  ranks.broadcast("begin");  // who starts late is no part of it
  const auto begin = Clock::now();
  ranks.share(
      count,
      [task_ms](std::size_t task) {
        std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(task_ms));
        return std::to_string(task);
      },
      [&taken](std::size_t, std::string_view) { ++taken; }, stop);
  const double passed = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  if (ranks.rank() != 0) return true;
  fmt::print("{} ranks, {} of {} tasks of {} ms in {:.0f} ms: {:.1f} %\n", ranks.size(), taken,
             count, task_ms, passed, 100.0 * task_ms * static_cast<double>(each) / passed);
  return taken == count;
}

}  // namespace

int main(int argc, char** argv) {
  const double task_ms = argc > 1 ? std::atof(argv[1]) : 50.0;
  const std::unique_ptr<softfinger::Ranks> ranks = softfinger::ranks_of_this_job();
  bool all = argc > 2 || share_out(*ranks, task_ms, 20);
  for (int k = 2; k < argc; ++k) {
    all = share_out(*ranks, task_ms, std::strtoull(argv[k], nullptr, 10)) && all;
  }
  return all ? 0 : 1;
}
