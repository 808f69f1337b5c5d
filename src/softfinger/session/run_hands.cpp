#include "softfinger/session/run_hands.hpp"

#include <algorithm>

namespace softfinger {

RunHands::RunHands(const Scene& scene) : hands_(scene.hands) {
  for (const SceneHand& hand : hands_) {
    trackers_.emplace_back();
    for (std::size_t p = 0; p < kHandPieces.size(); ++p) {
      const std::size_t object = hand.first_object + p;
      bones_.push_back({.object = static_cast<std::int64_t>(object), .step = -1});
      if (hand.script) continue;
      trackers_.back().push_back(std::make_unique<WebXrTracker>(
          scene.objects[object].motion.sample(0.0), hand.side, joint_of(p)));
    }
  }
  changed_.resize(bones_.size());
}

void RunHands::take(std::size_t bone, std::int64_t step, const Pose& X_WT, bool valid) {
  BoneRecord& last = bones_[bone];
  const StoredPose stored(X_WT);
  changed_[bone] = last.step < 0 || last.valid != valid ||
                   last.X_WT.translation != stored.translation ||
                   last.X_WT.rotation.coeffs() != stored.rotation.coeffs();
  last.X_WT = stored;
  last.valid = valid;
  last.step = step;
}

std::span<const BoneRecord> RunHands::sample(std::int64_t step, double time) {
  std::size_t bone = 0;
  for (std::size_t h = 0; h < hands_.size(); ++h) {
    HandPose scripted;
    if (hands_[h].script) scripted = hands_[h].script->sample(time);
    for (std::size_t p = 0; p < kHandPieces.size(); ++p, ++bone) {
      if (hands_[h].script) {
        take(bone, step, scripted.pieces.at(p), true);
      } else {
        const TrackedPose tracked = trackers_[h][p]->sample(time);
        take(bone, step, tracked.X_WFt, tracked.valid);
      }
    }
  }
  return bones_;
}

std::optional<double> RunHands::end_time() const {
  std::optional<double> end;
  for (const SceneHand& hand : hands_) {
    if (hand.script) end = std::max(end.value_or(0.0), hand.script->end_time());
  }
  return end;
}

void RunHands::offer(const XrHand& hand) noexcept {
  for (const auto& bones : trackers_) {
    for (const auto& tracker : bones) tracker->offer(hand);
  }
}

}  // namespace softfinger
