#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "softfinger/recording/record.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/tracking/page_tracker.hpp"
#include "softfinger/tracking/webxr_tracker.hpp"

namespace softfinger {

/// Where a scene's objects are wanted, step by step: bones of hands where they are tracked, other
/// rigid ones that move by forces where a person holds them.
class RunObjects {
 public:
  /// `scene` must outlive it.
  explicit RunObjects(const Scene& scene);

  /// Simulation thread; `time` in s, at the end of step `step`. A row for each object of the scene.
  /// Allocates nothing.
  std::span<const FollowRecord> sample(std::int64_t step, double time);
  /// Whether the last sample() changed anything of an object.
  [[nodiscard]] bool changed(std::size_t object) const { return changed_[object] != 0; }
  /// When the last script of a hand ends, s; empty: there is none.
  [[nodiscard]] std::optional<double> end_time() const;
  /// A headset's. One thread; wait-free.
  void offer(const XrHand& hand) noexcept;
  /// A person holds the object at X_WO, finite and rigid, until let_go() or until nothing was said
  /// for as long as the page tracker waits; nothing where VirtualObject::can_be_held() says no. The
  /// same thread; wait-free.
  void hold(std::size_t object, const Pose& X_WO) noexcept;
  void let_go(std::size_t object) noexcept;

 private:
  void take(std::size_t object, std::int64_t step, const Pose& X_WT, bool valid);

  std::span<const SceneHand> hands_;
  std::vector<std::vector<std::unique_ptr<WebXrTracker>>> trackers_;  ///< by hand, unless scripted
  std::vector<std::unique_ptr<PageTracker>> holds_;                   ///< by object; null: never
  std::atomic<bool> anything_held_{false};                            ///< so far
  std::vector<FollowRecord> rows_;
  std::vector<std::uint8_t> changed_;  ///< by object
};

}  // namespace softfinger
