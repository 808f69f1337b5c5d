#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "softfinger/recording/record.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/tracking/webxr_tracker.hpp"

namespace softfinger {

/// Where the bones of a scene's hands are tracked, step by step.
class RunHands {
 public:
  /// `scene` must outlive it.
  explicit RunHands(const Scene& scene);

  /// Simulation thread; `time` in s, at the end of step `step`. A row for each bone, in the order
  /// of the objects. Allocates nothing.
  std::span<const BoneRecord> sample(std::int64_t step, double time);
  /// Whether the last sample() changed anything of a bone.
  [[nodiscard]] bool changed(std::size_t bone) const { return changed_[bone] != 0; }
  /// When the last script ends, s; empty: there is none.
  [[nodiscard]] std::optional<double> end_time() const;
  /// A headset's. One thread; wait-free.
  void offer(const XrHand& hand) noexcept;

 private:
  void take(std::size_t bone, std::int64_t step, const Pose& X_WT, bool valid);

  std::span<const SceneHand> hands_;
  std::vector<std::vector<std::unique_ptr<WebXrTracker>>> trackers_;  ///< by hand, unless scripted
  std::vector<BoneRecord> bones_;
  std::vector<std::uint8_t> changed_;  ///< by bone
};

}  // namespace softfinger
