#include "softfinger/session/run_objects.hpp"

#include <algorithm>

namespace softfinger {

RunObjects::RunObjects(const Scene& scene)
    : hands_(scene.hands),
      holds_(scene.objects.size()),
      rows_(scene.objects.size()),
      changed_(scene.objects.size()) {
  for (std::size_t o = 0; o < rows_.size(); ++o) {
    const VirtualObject& object = scene.objects[o];
    rows_[o].object = static_cast<std::int64_t>(o);
    if (object.hand() >= 0) rows_[o].step = -1;  // told from the start
    if (object.can_be_held()) holds_[o] = std::make_unique<PageTracker>(object.motion.sample(0.0));
  }
  for (const SceneHand& hand : hands_) {
    trackers_.emplace_back();
    for (std::size_t p = 0; !hand.script && p < kHandPieces.size(); ++p) {
      const VirtualObject& bone = scene.objects[hand.first_object + p];
      trackers_.back().push_back(
          std::make_unique<WebXrTracker>(bone.motion.sample(0.0), hand.side, joint_of(p)));
    }
  }
}

void RunObjects::take(std::size_t object, std::int64_t step, const Pose& X_WT, bool valid) {
  FollowRecord& last = rows_[object];
  const StoredPose stored(X_WT);
  changed_[object] = last.step < 0 || last.valid != valid ||
                     last.X_WT.translation != stored.translation ||
                     last.X_WT.rotation.coeffs() != stored.rotation.coeffs();
  last.X_WT = stored;
  last.valid = valid;
  last.step = step;
}

std::span<const FollowRecord> RunObjects::sample(std::int64_t step, double time) {
  const bool anything_held = anything_held_.load(std::memory_order_relaxed);
  for (std::size_t o = 0; anything_held && o < holds_.size(); ++o) {
    if (!holds_[o]) continue;
    const TrackedPose held = holds_[o]->sample(time);
    // Where nobody holds it nothing is told of it.
    const bool told = held.valid || rows_[o].valid;
    changed_[o] = 0;
    if (told) take(o, step, held.X_WFt, held.valid);
  }
  for (std::size_t h = 0; h < hands_.size(); ++h) {
    HandPose scripted;
    if (hands_[h].script) scripted = hands_[h].script->sample(time);
    for (std::size_t p = 0; p < kHandPieces.size(); ++p) {
      const std::size_t object = hands_[h].first_object + p;
      if (hands_[h].script) {
        take(object, step, scripted.pieces.at(p), true);
      } else {
        const TrackedPose tracked = trackers_[h][p]->sample(time);
        take(object, step, tracked.X_WFt, tracked.valid);
      }
    }
  }
  return rows_;
}

std::optional<double> RunObjects::end_time() const {
  std::optional<double> end;
  for (const SceneHand& hand : hands_) {
    if (hand.script) end = std::max(end.value_or(0.0), hand.script->end_time());
  }
  return end;
}

void RunObjects::offer(const XrHand& hand) noexcept {
  for (const auto& bones : trackers_) {
    for (const auto& tracker : bones) tracker->offer(hand);
  }
}

void RunObjects::hold(std::size_t object, const Pose& X_WO) noexcept {
  if (object >= holds_.size() || !holds_[object]) return;
  holds_[object]->offer(X_WO);
  anything_held_.store(true, std::memory_order_relaxed);
}

void RunObjects::let_go(std::size_t object) noexcept {
  if (object < holds_.size() && holds_[object]) holds_[object]->let_go();
}

}  // namespace softfinger
