#include "softfinger/threads/parallel_for.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace softfinger {

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work,
                  const Progress& progress) {
  std::atomic<std::size_t> next{0};
  const std::size_t threads =
      std::min<std::size_t>(count, std::max(1U, std::thread::hardware_concurrency()));
  std::vector<std::exception_ptr> failures(std::max<std::size_t>(threads, 1));
  const auto take = [&](std::size_t thread) {
    try {
      for (std::size_t i = next++; i < count; i = next++) {
        work(i);
        if (thread == 0 && progress) progress(static_cast<double>(i) / static_cast<double>(count));
      }
    } catch (...) {
      failures[thread] = std::current_exception();
      next = count;
    }
  };
  std::vector<std::jthread> others;
  for (std::size_t thread = 1; thread < threads; ++thread) others.emplace_back(take, thread);
  take(0);
  others.clear();  // waits
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace softfinger
