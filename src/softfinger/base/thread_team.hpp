#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
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
  /// `threads` in all, at least 1; the calling one is among them.
  explicit ThreadTeam(int threads);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  [[nodiscard]] int threads() const { return static_cast<int>(helpers_.size()) + 1; }
  /// Calls work(i, thread) once for each i < count and returns when all have returned; thread is
  /// in [0, threads()), and its calls follow one another. The calls must not depend on each other.
  template <typename Work>
  void run(std::size_t count, const Work& work) {
    if (helpers_.empty() || count < 2) {
      for (std::size_t i = 0; i < count; ++i) work(i, 0);
      return;
    }
    share(count, &work, [](const void* w, std::size_t i, int thread) {
      (*static_cast<const Work*>(w))(i, thread);
    });
  }

 private:
  using Call = void (*)(const void* work, std::size_t i, int thread);
  void share(std::size_t count, const void* work, Call call);
  /// Takes part in job `job` as long as there is something left of it.
  void take_part(std::uint32_t job, int thread);
  void help(int thread);

  // Of the job under way. `next_` has the job's number in its upper half and the next index in its
  // lower one, so that who comes late cannot take from the job after.
  std::atomic<std::uint64_t> next_{0};
  std::atomic<std::size_t> count_{0};
  std::atomic<const void*> work_{nullptr};
  std::atomic<Call> call_{nullptr};
  std::atomic<std::size_t> done_{0};

  std::atomic<std::uint32_t> job_{0};  ///< what helpers wait on
  std::atomic<int> asleep_{0};
  std::atomic<bool> ending_{false};
  std::vector<std::thread> helpers_;
};

}  // namespace softfinger
