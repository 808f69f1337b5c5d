#include "softfinger/loop/finger_loop.hpp"

#include <chrono>

#include "softfinger/base/hash.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {

FingerLoop::FingerLoop(std::int64_t finger, std::shared_ptr<const FingerModel> model,
                       std::span<const VirtualObject> objects, double simulation_rate,
                       bool with_state, ThreadTeam* team, int hand)
    : simulation_(std::move(model), objects, 1.0 / simulation_rate, team, hand),
      simulation_rate_(simulation_rate) {
  record_.finger = finger;
  if (with_state) {
    record_.nodes_W.resize(simulation_.model().mesh.nodes.size());
    record_.samples.resize(simulation_.model().sample_nodes.size());
  }
}

void FingerLoop::start(const TrackedInput& tracked) {
  record_.step = 0;
  record_.time = 0.0;
  record_.tracked = tracked;
  X_WFt_limited_ = tracked.X_WFt.pose();
  placed_ = tracked.valid;
  if (placed_) {
    simulation_.reset(X_WFt_limited_, 0.0);
    // Of a finger that starts inside something, what it touches is known once the skin gave way.
    if (simulation_.contact().normal_force > 0.0) {
      place(0);
      (void)simulation_.step(X_WFt_limited_, 0.0);
    }
  } else {
    simulation_.put_aside(X_WFt_limited_);
  }
  record_.iterations = 0;
  record_.converged = true;
  record_.residual = 0.0;
  record_.cpu_time = 0.0;
  record_.wall_time = 0.0;
  read_simulation();
}

void FingerLoop::step(std::int64_t step, const TrackedInput& tracked) {
  const bool takes_part = begin_step(step, tracked);
  const auto began = std::chrono::steady_clock::now();
  const double cpu_began = thread_cpu_time();
  const StepSummary summary = takes_part ? simulation_.solve_step() : StepSummary{};
  end_step(summary,
           {thread_cpu_time() - cpu_began,
            std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count()});
}

bool FingerLoop::begin_step(std::int64_t step, const TrackedInput& tracked) {
  const auto began = std::chrono::steady_clock::now();
  const double cpu_began = thread_cpu_time();
  record_.step = step;
  record_.time = static_cast<double>(step) / simulation_rate_;
  record_.tracked = tracked;
  // Until there is a pose the finger waits where it was put aside.
  takes_part_ = placed_ || tracked.valid;
  if (placed_) {
    X_WFt_limited_ =
        moved_towards(X_WFt_limited_, tracked.X_WFt.pose(), kMaxTrackedSpeed / simulation_rate_,
                      kMaxTrackedAngularSpeed / simulation_rate_);
  } else if (tracked.valid) {
    placed_ = true;
    X_WFt_limited_ = tracked.X_WFt.pose();
    place(step);
  }
  if (takes_part_) simulation_.begin_step(X_WFt_limited_, record_.time);
  cpu_time_ = thread_cpu_time() - cpu_began;
  wall_time_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return takes_part_;
}

void FingerLoop::end_step(const StepSummary& summary, SolvingTime solving) {
  const auto began = std::chrono::steady_clock::now();
  const double cpu_began = thread_cpu_time();
  if (takes_part_) simulation_.end_step();
  record_.iterations = summary.iterations;
  record_.converged = summary.converged;
  record_.residual = summary.relative_residual;
  read_simulation();
  record_.cpu_time = cpu_time_ + solving.cpu + thread_cpu_time() - cpu_began;
  record_.wall_time =
      wall_time_ + solving.wall +
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

void FingerLoop::place(std::int64_t step) {
  simulation_.reset(X_WFt_limited_, static_cast<double>(step - 1) / simulation_rate_);
}

void FingerLoop::read_simulation() {
  const ContactSet& contact = simulation_.contact();
  record_.X_WF = StoredPose(simulation_.bone_pose());
  record_.sums() = contact.sums();
  if (record_.nodes_W.empty()) return;
  const std::span<const Vector3> positions = simulation_.positions();
  for (std::size_t i = 0; i < record_.nodes_W.size(); ++i) record_.nodes_W[i] = positions[i];
  for (std::size_t i = 0; i < record_.samples.size() && i < contact.samples.size(); ++i) {
    const ContactSample& sample = contact.samples[i];
    record_.samples[i] = {sample.position_F, sample.gap,
                          sample.normal_force_F + sample.tangential_force_F,
                          sample.in_contact ? 1.0 : 0.0};
  }
}

const StepRecord& FingerLoop::seal(std::int64_t tick, std::uint64_t tick_hash,
                                   std::uint64_t world) {
  record_.tick = tick;
  std::uint64_t state = simulation_.state_hash();
  if (world != 0) state = Hash().add(state).add(world).value();
  record_.hash = hash_of(record_, state, tick_hash);
  return record_;
}

}  // namespace softfinger
