#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/geometry/mesh_shape.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/softfinger.h"

namespace softfinger {

/// What a host program and a long call see of each other: the host's flag that ends it, also while
/// a scene loads, and how far it is. Either may be null.
class HostWatch {
 public:
  HostWatch(const volatile std::int32_t* stop, volatile double* progress)
      : progress_(progress), asked_(stop) {
    if (progress_ != nullptr) *progress_ = 0.0;
    if (stop == nullptr) return;
    stop_ = *stop != 0;
    watcher_ = std::jthread([this, stop](const std::stop_token& end) {
      while (!end.stop_requested() && !stop_.load()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        stop_ = *stop != 0;
      }
    });
  }

  explicit HostWatch(const sf_watch& watch) : HostWatch(watch.stop, watch.progress) {}

  [[nodiscard]] const std::atomic<bool>& stop() const { return stop_; }
  /// Takes the part done; throws OperationError, "WORK: was ended before it was done", where the
  /// host wants no more of it.
  [[nodiscard]] std::function<void(double)> ending(std::string work) const {
    return [this, work = std::move(work)](double part) {
      if (asked_ != nullptr && *asked_ != 0) {
        throw OperationError(work + ": was ended before it was done");
      }
      if (progress_ != nullptr) *progress_ = part;
    };
  }
  /// Ends what loads, with an InputError, where meshes are.
  [[nodiscard]] LoadObserver load_observer() const {
    LoadObserver observer;
    observer.progress = [this](double part) { ending("loading")(part); };
    return observer;
  }
  /// Says how far a run is, of 1; for as long as this lives.
  [[nodiscard]] RunObserver observer() const {
    RunObserver observer;
    if (progress_ == nullptr) return observer;
    observer.progress = [to = progress_](double time, std::optional<double> end) {
      if (end && *end > 0.0) *to = time / *end;
    };
    return observer;
  }

 private:
  volatile double* progress_;
  const volatile std::int32_t* asked_;
  std::atomic<bool> stop_{false};
  std::jthread watcher_;
};

/// 0: none given. Throws InputError.
[[nodiscard]] inline std::optional<double> duration_of(double duration_s) {
  if (duration_s == 0.0) return std::nullopt;
  if (std::isfinite(duration_s) && duration_s > 0.0) return duration_s;
  throw InputError("duration_s: must be a time above 0 in seconds");
}

}  // namespace softfinger
