#pragma once

#include <atomic>
#include <deque>
#include <future>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>

#include "softfinger/session/run_setup.hpp"

namespace softfinger {

/// A scene that loads on a thread of its own, while a run and those who wait for it go on. All
/// functions are for one thread, which the observer of `options` is told on as well.
class SceneLoad {
 public:
  explicit SceneLoad(const SetupOptions& options);
  /// Gives it up, and waits for its end.
  ~SceneLoad();
  SceneLoad(const SceneLoad&) = delete;
  SceneLoad& operator=(const SceneLoad&) = delete;

  /// Nobody wants it any more: it ends within a fraction of a second, and leaves nothing behind.
  void give_up() { stop_.request_stop(); }
  [[nodiscard]] bool given_up() const { return stop_.stop_requested(); }
  /// Tells the observer what is new. Whether take() returns at once.
  bool done();
  /// What load_setup returns or throws. Once.
  [[nodiscard]] std::shared_ptr<const RunSetup> take() { return setup_.get(); }

 private:
  void tell();

  LoadObserver observer_;
  std::stop_source stop_;
  std::atomic<double> progress_{0.0};
  double told_progress_ = 0.0;
  std::mutex mutex_;
  std::deque<std::string> messages_;
  std::future<std::shared_ptr<const RunSetup>> setup_;
};

/// load_setup() that ends soon after `stop` becomes true: null then. Meanwhile the observer is told
/// on this thread. Throws InputError.
[[nodiscard]] std::shared_ptr<const RunSetup> load_unless_stopped(const SetupOptions& options,
                                                                  const std::atomic<bool>& stop);

}  // namespace softfinger
