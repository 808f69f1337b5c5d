#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/world/world.hpp"

namespace softfinger {

inline constexpr double kStep = 1e-3;
inline constexpr double kGravity = 9.81;
inline const Vector3 kDown(0.0, 0.0, -kGravity);
inline constexpr double kPad = 7.2e-3;  // m, of the shipped finger's pad from F, along -z

/// 0 until `from`, 1 after `to`, still at both.
inline double smooth(double time, double from, double to) {
  const double s = std::clamp((time - from) / (to - from), 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

inline VirtualObject still(const char* name, Shape shape, const Vector3& at = Vector3::Zero(),
                           double friction = 0.5) {
  return {name, std::move(shape), Trajectory(Pose{Matrix3::Identity(), at}), friction};
}

inline VirtualObject loose(const char* name, Shape shape, const Vector3& at, double mass,
                           double friction = 0.5) {
  VirtualObject object = still(name, std::move(shape), at, friction);
  object.dynamics = ObjectDynamics{.mass = mass};
  return object;
}

/// Objects, and shipped fingers that follow functions of time.
class Play {
 public:
  using Path = std::function<Pose(double)>;
  explicit Play(std::vector<VirtualObject> objects, const Vector3& gravity = kDown,
                std::vector<Path> paths = {}, ThreadTeam* team = nullptr)
      : objects_(std::move(objects)),
        paths_(std::move(paths)),
        world_(objects_, gravity, kStep, team) {
    for (const Path& path : paths_) {
      static const auto model =
          FingerModel::load(std::filesystem::path(source_folder()) / "fingers/index.toml");
      fingers_.push_back(std::make_unique<FingerSimulation>(model, objects_, kStep));
      world_.add(*fingers_.back());
      all_.push_back(fingers_.back().get());
      fingers_.back()->reset(path(0.0));
    }
    summaries_.resize(all_.size());
    world_.reset();
  }
  void step() {
    ++steps_;
    world_.begin_step(time());
    for (std::size_t f = 0; f < all_.size(); ++f) all_[f]->begin_step(paths_[f](time()), time());
    world_.solve(all_, summaries_);
    for (FingerSimulation* finger : all_) finger->end_step();
    events_.insert(events_.end(), world_.events().begin(), world_.events().end());
    unconverged_ += world_.summary().converged ? 0 : 1;
    iterations_ += world_.summary().iterations;
  }
  /// Fingers are seen no more: they take no part in the steps that follow.
  void leave() { all_.clear(); }
  void run(double duration) {
    const auto steps = std::lround(duration / kStep);
    for (long k = 0; k < steps; ++k) step();
  }

  [[nodiscard]] double time() const { return steps_ * kStep; }
  [[nodiscard]] const std::vector<VirtualObject>& objects() const { return objects_; }
  [[nodiscard]] const FingerSimulation& finger(std::size_t f) const { return *fingers_[f]; }
  [[nodiscard]] const ObjectState& state(std::size_t o) const { return world_.state(o); }
  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] const std::vector<WorldEvent>& events() const { return events_; }
  [[nodiscard]] int unconverged() const { return unconverged_; }
  /// Newton's iterations a step.
  [[nodiscard]] double iterations() const { return iterations_ / std::max(1, steps_); }

 private:
  std::vector<VirtualObject> objects_;
  std::vector<Path> paths_;
  World world_;
  std::vector<std::unique_ptr<FingerSimulation>> fingers_;
  std::vector<FingerSimulation*> all_;
  std::vector<StepSummary> summaries_;
  std::vector<WorldEvent> events_;
  int steps_ = 0;
  int unconverged_ = 0;
  double iterations_ = 0.0;
};

}  // namespace softfinger
