#include "world_scene.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "../tests/support/folders.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {

WorldScene WorldScene::shipped(const std::string& name) {
  return WorldScene(
      load_scene(std::filesystem::path(source_folder()) / "scenes" / (name + ".toml")));
}

WorldScene::WorldScene(Scene scene) : scene_(std::make_unique<Scene>(std::move(scene))) {
  const double time_step = 1.0 / scene_->simulation_rate;
  world_ = std::make_unique<World>(scene_->objects, scene_->gravity, time_step);
  for (const SceneFinger& finger : scene_->fingers) {
    trackers_.push_back(finger.make_tracker(scene_->file.parent_path()));
    fingers_.push_back(std::make_unique<FingerSimulation>(
        FingerModel::load(finger.model), scene_->objects, time_step, nullptr, finger.hand));
    world_->add(*fingers_.back());
    all_.push_back(fingers_.back().get());
    duration_ = std::max(duration_, trackers_.back()->end_time().value_or(0.0));
  }
  summaries_.resize(all_.size());
  reset();
}

void WorldScene::reset() {
  step_ = 0;
  for (std::size_t f = 0; f < fingers_.size(); ++f) {
    fingers_[f]->reset(trackers_[f]->sample(0.0).X_WFt);
  }
  world_->reset();
  wanted_ = std::make_unique<RunObjects>(*scene_);
}

void WorldScene::step() {
  const double time_step = 1.0 / scene_->simulation_rate;
  if (duration_ > 0.0 && static_cast<double>(step_) * time_step >= duration_) reset();
  ++step_;
  const double time = static_cast<double>(step_) * time_step;
  for (const FollowRecord& row : wanted_->sample(step_, time)) {
    const auto o = static_cast<std::size_t>(row.object);
    if (scene_->objects[o].hand() < 0) continue;
    const Pose X_WT = row.X_WT.pose();
    world_->follow(o, row.valid ? &X_WT : nullptr);
  }
  world_->begin_step(time);
  for (std::size_t f = 0; f < fingers_.size(); ++f) {
    fingers_[f]->begin_step(trackers_[f]->sample(time).X_WFt, time);
  }
  world_->solve(all_, summaries_);
  for (const auto& finger : fingers_) finger->end_step();
}

}  // namespace softfinger
