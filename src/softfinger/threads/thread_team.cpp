#include "softfinger/threads/thread_team.hpp"

#include <chrono>

#include "softfinger/threads/spin_until.hpp"

namespace softfinger {
namespace {

using Clock = std::chrono::steady_clock;

/// How long a helper looks out for the next job before it sleeps: longer than the pauses within a
/// step, shorter than those between steps.
constexpr auto kLookout = std::chrono::microseconds(100);
constexpr int kLooksAClock = 64;

}  // namespace

ThreadTeam::ThreadTeam(int threads, const std::function<void()>& on_helper) {
  for (int thread = 1; thread < threads; ++thread) {
    helpers_.emplace_back([this, thread, on_helper] {
      if (on_helper) on_helper();
      help(thread);
    });
  }
}

ThreadTeam::~ThreadTeam() {
  ending_.store(true);
  job_.fetch_add(1);
  job_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void ThreadTeam::share_out(std::size_t count, const void* work, Call call) {
  const std::uint32_t job = job_.load(std::memory_order_relaxed) + 1;
  done_.store(0, std::memory_order_relaxed);
  work_.store(work, std::memory_order_relaxed);
  call_.store(call, std::memory_order_relaxed);
  count_.store(count, std::memory_order_relaxed);
  left_.store(std::uint64_t{job} << 32 | count, std::memory_order_release);
  job_.store(job);  // before asleep_ is read: who goes to sleep counts itself first, then looks
  if (asleep_.load() > 0) job_.notify_all();
  take_part(job, 0);
  spin_until([&] { return done_.load(std::memory_order_acquire) == count; });
}

void ThreadTeam::take_part(std::uint32_t job, int thread) {
  std::uint64_t left = left_.load(std::memory_order_acquire);
  while (left >> 32 == job && (left & 0xffffffffU) > 0) {
    // Of this job, if the exchange succeeds: the next one starts only when nothing is left.
    const std::size_t count = count_.load(std::memory_order_relaxed);
    const void* work = work_.load(std::memory_order_relaxed);
    const Call call = call_.load(std::memory_order_relaxed);
    if (!left_.compare_exchange_weak(left, left - 1, std::memory_order_acq_rel)) continue;
    call(work, count - (left & 0xffffffffU), thread);
    done_.fetch_add(1, std::memory_order_acq_rel);
    left = left_.load(std::memory_order_acquire);
  }
}

void ThreadTeam::help(int thread) {
  std::uint32_t known = 0;
  while (true) {
    std::uint32_t job = job_.load(std::memory_order_acquire);
    const Clock::time_point until = Clock::now() + kLookout;
    while (job == known && !ending_.load(std::memory_order_relaxed)) {
      for (int look = 0; look < kLooksAClock && job == known; ++look) {
        pause_while_looking();
        job = job_.load(std::memory_order_acquire);
      }
      if (job != known || Clock::now() < until) continue;
      asleep_.fetch_add(1);
      job_.wait(known);
      asleep_.fetch_sub(1);
      job = job_.load(std::memory_order_acquire);
    }
    if (ending_.load()) return;
    known = job;
    take_part(job, thread);
  }
}

}  // namespace softfinger
