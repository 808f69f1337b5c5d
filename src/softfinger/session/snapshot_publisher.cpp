#include "softfinger/session/snapshot_publisher.hpp"

#include <utility>

#include "softfinger/session/scene_snapshot.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

Snapshot first_snapshot(const RunSetup& setup, std::uint64_t generation,
                        const SnapshotPublisher::Fingers& fingers) {
  Snapshot snapshot = initial_snapshot(setup);
  snapshot.generation = generation;
  for (std::size_t i = 0; i < fingers.size(); ++i) {
    LiveDevice* const device = fingers[i]->live.get();
    if (device == nullptr) continue;
    fill(snapshot.fingers[i], device->feedback());
    if (const LiveTwin* twin = device->twin()) snapshot.fingers[i].twin = twin->latest();
  }
  return snapshot;
}

}  // namespace

SnapshotPublisher::SnapshotPublisher(std::shared_ptr<const RunSetup> setup,
                                     std::uint64_t generation, const Fingers& fingers)
    : setup_(std::move(setup)), snapshots_(first_snapshot(*setup_, generation, fingers)) {}

void SnapshotPublisher::publish(const Moment& moment, const SceneLoop& scene,
                                const Fingers& fingers) {
  Snapshot& draft = snapshots_.draft();
  draft.step = static_cast<std::uint64_t>(moment.step);
  draft.time = moment.time;
  draft.wall_time = monotonic_time();
  draft.paused = moment.paused;
  draft.stops = moment.stops;
  draft.stopped = moment.stopped;
  draft.finished = moment.finished;
  draft.step_cpu_time = 0.0;
  draft.match_cpu_time = 0.0;
  draft.deadline_misses = moment.deadline_misses;
  for (std::size_t i = 0; i < draft.X_WO.size(); ++i) {
    draft.X_WO[i] = scene.object_pose(i);
  }
  for (Snapshot::SoftObject& soft : draft.soft_objects) {
    fill(soft, *setup_->scene.objects[soft.object].soft, draft.X_WO[soft.object],
         scene.object_nodes(soft.object));
  }
  for (std::size_t i = 0; i < fingers.size(); ++i) {
    Snapshot::Finger& finger = draft.fingers[i];
    const FingerChain& chain = *fingers[i]->chain;
    fill(finger, chain.loop());
    draft.step_cpu_time += chain.loop().record().cpu_time;
    LiveDevice* const device = fingers[i]->live.get();
    if (device == nullptr) continue;
    fill(finger, device->feedback());
    draft.match_cpu_time += device->feedback().tick.cpu_time;
    // Also where no tick tells it: stopped in a pause.
    if (const auto state = chain.device().actuator().line_state()) {
      finger.device_state = state_name(*state);
      finger.device_said = chain.device().actuator().line_silence();
    }
    if (LiveTwin* twin = device->twin()) {
      twin->refresh();
      finger.twin = twin->latest();
    }
  }
  snapshots_.publish();
}

}  // namespace softfinger
