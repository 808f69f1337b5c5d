#include "softfinger/loop/scene_loop.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include "softfinger/threads/thread_clock.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger {

SceneLoop::SceneLoop(std::span<const VirtualObject> objects, const Vector3& gravity,
                     double simulation_rate, ThreadTeam* team, bool with_state)
    : objects_(objects), simulation_rate_(simulation_rate), team_(team), with_state_(with_state) {
  const auto moves = [](const VirtualObject& object) { return object.moves_by_forces(); };
  if (std::ranges::none_of(objects, moves)) return;
  world_.emplace(objects, gravity, 1.0 / simulation_rate, team);
  events_.reserve(WorldEvents::kMostOpen);
  for (std::size_t o = 0; o < objects.size(); ++o) {
    if (!moves(objects[o])) continue;
    ObjectRecord& record = records_.emplace_back();
    record.object = static_cast<std::int64_t>(o);
    if (with_state) record.nodes_W.resize(world_->nodes(o).size());
    const bool is_bone = objects[o].hand() >= 0;
    if (is_bone || objects[o].can_be_held()) {
      followers_.push_back({.object = o, .is_bone = is_bone});
    }
  }
}

void SceneLoop::add(FingerChain& chain) {
  chains_.push_back(&chain);
  takes_part_.push_back(0);
  simulations_.reserve(chains_.size());
  summaries_.resize(chains_.size());
  if (world_) world_->add(chain.simulation());
}

void SceneLoop::follow(std::span<const FollowRecord> wanted) {
  for (Follower& follower : followers_) {
    const FollowRecord* const row = wanted.empty() ? nullptr : &wanted[follower.object];
    const bool valid = row != nullptr && row->valid;
    if (valid) {
      const Pose X_WT = row->X_WT.pose();
      // A bone appears where it is seen first.
      const Pose from = follower.led       ? follower.X_WT
                        : follower.is_bone ? X_WT
                                           : world_->state(follower.object).X_WO;
      follower.X_WT = moved_towards(from, X_WT, kMaxTrackedSpeed / simulation_rate_,
                                    kMaxTrackedAngularSpeed / simulation_rate_);
    }
    follower.led = valid || (follower.is_bone && follower.led);
    const Pose* const X_WT = follower.led ? &follower.X_WT : nullptr;
    if (follower.is_bone) {
      world_->follow(follower.object, X_WT);
    } else {
      world_->hold(follower.object, X_WT);
    }
  }
}

void SceneLoop::start(std::span<const FollowRecord> wanted) {
  step_ = 0;
  unconverged_steps_ = 0;
  if (!world_) return;
  world_->reset();
  for (Follower& follower : followers_) follower.led = false;
  follow({});  // bones are nowhere
  follow(wanted);
  events_.clear();
  events_told_ = 0;
  record();
}

void SceneLoop::finish() {
  if (!world_) return;
  world_->finish();
  record_events();
}

void SceneLoop::step(std::int64_t step, std::span<const TrackedInput> tracked,
                     std::span<const FollowRecord> wanted) {
  step_ = step;
  const auto for_each_chain = [&](const auto& work) {
    if (team_ != nullptr) {
      team_->run(chains_.size(), [&](std::size_t i, int) { work(i); });
    } else {
      for (std::size_t i = 0; i < chains_.size(); ++i) work(i);
    }
  };
  if (!world_) {
    for_each_chain([&](std::size_t i) { chains_[i]->step(step, tracked[i]); });
    return;
  }
  follow(wanted);
  world_->begin_step(static_cast<double>(step) / simulation_rate_);
  for_each_chain(
      [&](std::size_t i) { takes_part_[i] = chains_[i]->begin_step(step, tracked[i]) ? 1 : 0; });
  const auto began = std::chrono::steady_clock::now();
  const double cpu_began = thread_cpu_time();
  simulations_.clear();
  for (std::size_t i = 0; i < chains_.size(); ++i) {
    if (takes_part_[i] != 0) simulations_.push_back(&chains_[i]->simulation());
  }
  world_->solve(simulations_, summaries_);
  const FingerLoop::SolvingTime solving{
      thread_cpu_time() - cpu_began,
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count()};
  const auto converged = [](const StepSummary& summary) { return summary.converged; };
  const std::span<const StepSummary> ended(summaries_.data(), simulations_.size());
  if (!world_->summary().converged && std::ranges::all_of(ended, converged)) ++unconverged_steps_;
  const std::uint64_t hash = world_->state_hash();
  std::size_t next = 0;
  for (std::size_t i = 0; i < chains_.size(); ++i) {
    const StepSummary summary = takes_part_[i] != 0 ? summaries_[next++] : StepSummary{};
    chains_[i]->end_step(summary, solving, hash);
  }
  record();
  record_events();
}

Pose SceneLoop::object_pose(std::size_t object) const {
  if (objects_[object].moves_by_forces()) return world_->state(object).X_WO;
  return objects_[object].motion.sample(static_cast<double>(step_) / simulation_rate_);
}

std::span<const Vector3> SceneLoop::object_nodes(std::size_t object) const {
  return world_ ? world_->nodes(object) : std::span<const Vector3>();
}

ObjectRecord SceneLoop::largest_object() const {
  const auto size = [](const ObjectRecord& record) { return record.nodes_W.size(); };
  const auto largest = std::ranges::max_element(records_, {}, size);
  return largest == records_.end() ? ObjectRecord{} : *largest;
}

void SceneLoop::record_events() {
  events_.clear();
  for (const WorldEvent& event : world_->events()) {
    events_.push_back({.step = step_,
                       .number = events_told_++,
                       .time = event.time,
                       .kind = static_cast<std::int64_t>(event.kind),
                       .object = event.object,
                       .other = event.other,
                       .impulse = event.impulse});
  }
}

void SceneLoop::record() {
  for (ObjectRecord& record : records_) {
    const ObjectState& state = world_->state(static_cast<std::size_t>(record.object));
    record.step = step_;
    record.time = static_cast<double>(step_) / simulation_rate_;
    record.X_WO = StoredPose(state.X_WO);
    record.velocity = state.velocity;
    record.angular_velocity = state.angular_velocity;
    record.joint = state.has_joint ? state.joint : std::numeric_limits<double>::quiet_NaN();
    if (with_state_) {
      const std::span<const Vector3> nodes = object_nodes(static_cast<std::size_t>(record.object));
      record.nodes_W.assign(nodes.begin(), nodes.end());
    }
  }
}

}  // namespace softfinger
