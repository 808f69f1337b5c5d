#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace softfinger {

/// A few threads that share work for microseconds, many times a millisecond. Whoever calls run()
/// works too and waits only for what another thread has begun, so that a team whose helpers do not
/// get a processor costs little. run() allocates nothing and takes no lock. Helpers look out for
/// work for a short time after the last, then sleep.
///
/// One thread at a time may call run().
class ThreadTeam {
 public:
  /// `threads` in all, at least 1; the calling one is among them. Each other one, the helpers,
  /// calls on_helper() first, for its scheduling.
  explicit ThreadTeam(int threads, const std::function<void()>& on_helper = {});
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  [[nodiscard]] int threads() const { return static_cast<int>(helpers_.size()) + 1; }
  /// Calls work(i, thread) once for each i < count and returns when all have returned; thread is
  /// in [0, threads()), and its calls follow one another. Calls begin in the order of i: one may
  /// wait for another of smaller i, and for no other.
  template <typename Work>
  void run(std::size_t count, const Work& work) {
    if (helpers_.empty() || count < 2) {
      for (std::size_t i = 0; i < count; ++i) work(i, 0);
      return;
    }
    share_out(count, &work, [](const void* w, std::size_t i, int thread) {
      (*static_cast<const Work*>(w))(i, thread);
    });
  }

 private:
  using Call = void (*)(const void* work, std::size_t i, int thread);
  void share_out(std::size_t count, const void* work, Call call);
  /// Takes part in job `job` as long as there is something left of it.
  void take_part(std::uint32_t job, int thread);
  void help(int thread);

  // Of the job under way. `left_` has the job's number in its upper half and how many calls have
  // not begun in its lower one, so that who comes late takes nothing.
  std::atomic<std::uint64_t> left_{0};
  std::atomic<std::size_t> count_{0};
  std::atomic<const void*> work_{nullptr};
  std::atomic<Call> call_{nullptr};
  std::atomic<std::size_t> done_{0};

  std::atomic<std::uint32_t> job_{0};  ///< what helpers wait on
  std::atomic<int> asleep_{0};
  std::atomic<bool> ending_{false};
  std::vector<std::thread> helpers_;
};

/// team->run(), or the same on the calling thread alone where there is no team.
template <typename Work>
void share(ThreadTeam* team, std::size_t count, const Work& work) {
  if (team != nullptr) {
    team->run(count, work);
  } else {
    for (std::size_t i = 0; i < count; ++i) work(i, 0);
  }
}

/// The same for calls that do not wait for each other, in any order: the calling thread begins at
/// the first and the others at the last, so that work that comes again and again finds more of its
/// data where it left them.
template <typename Work>
void share_from_both_ends(ThreadTeam* team, std::size_t count, const Work& work) {
  std::size_t from_front = 0;
  std::atomic<std::size_t> from_back{0};
  share(team, count, [&](std::size_t, int thread) {
    const std::size_t i =
        thread == 0 ? from_front++ : count - 1 - from_back.fetch_add(1, std::memory_order_relaxed);
    work(i, thread);
  });
}

}  // namespace softfinger
