#include "scenario.hpp"

#include <algorithm>
#include <filesystem>

#include "../tests/support/folders.hpp"
#include "soak/violent_motion.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/loop/finger_loop.hpp"

namespace softfinger {
namespace {

// With which elements by themselves follow the press of the shipped fingers.
constexpr double kOwnModulus = 34e3;  // Pa
constexpr double kOwnPoissonsRatio = 0.27;

Scene shipped_scene(const std::string& name) {
  return load_scene(std::filesystem::path(source_folder()) / "scenes" / (name + ".toml"));
}

std::shared_ptr<const FingerModel> shipped_finger(const std::string& name) {
  return FingerModel::load(std::filesystem::path(source_folder()) / "fingers" / (name + ".toml"));
}

}  // namespace

Scenario scripted(const std::string& scene, const std::string& finger, double time_step,
                  double begin, double end) {
  Scene shipped = shipped_scene(scene);
  const Trajectory script(shipped.fingers.front().waypoints);
  Scenario scenario{shipped_finger(finger), std::move(shipped.objects), time_step, {}};
  const auto steps =
      static_cast<int>((std::min(end, script.end_time()) - begin) / time_step + 1e-9);
  for (int k = 0; k <= steps; ++k) scenario.path.push_back(script.sample(begin + k * time_step));
  return scenario;
}

std::vector<Scenario> shipped_hand(double time_step) {
  const Scene shipped = shipped_scene("hand");
  std::vector<Scenario> hand;
  for (const SceneFinger& finger : shipped.fingers) {
    const Trajectory script(finger.waypoints);
    hand.push_back({FingerModel::load(finger.model), shipped.objects, time_step, {}});
    const auto steps = static_cast<int>(script.end_time() / time_step + 1e-9);
    for (int k = 0; k <= steps; ++k) hand.back().path.push_back(script.sample(k * time_step));
  }
  return hand;
}

Scenario violent_on_edge(const std::string& finger, double time_step, int steps) {
  Scene shipped = shipped_scene("edge");
  std::get<RoundedBox>(shipped.objects.front().shape).edge_radius = 1.0 * mm;
  ViolentMotion motion(shipped.fingers.front().waypoints, 1);
  Scenario scenario{shipped_finger(finger), std::move(shipped.objects), time_step, {}};
  Pose X_WFt = motion.sample(0.0);
  for (int k = 0; k <= steps; ++k) {
    X_WFt = moved_towards(X_WFt, motion.sample(k * time_step), kMaxTrackedSpeed * time_step,
                          kMaxTrackedAngularSpeed * time_step);
    scenario.path.push_back(X_WFt);
  }
  return scenario;
}

Scenario plain(Scenario scenario) {
  auto model = std::make_shared<FingerModel>(*scenario.model);
  model->feature_contact = false;
  model->dilatation = Dilatation::kElement;
  for (auto& material : model->materials) {
    material.youngs_modulus = kOwnModulus;
    material.poissons_ratio = kOwnPoissonsRatio;
  }
  scenario.model = std::move(model);
  return scenario;
}

Scenario frictionless(Scenario scenario) {
  for (VirtualObject& object : scenario.objects) object.friction_coefficient = 0.0;
  return scenario;
}

}  // namespace softfinger
