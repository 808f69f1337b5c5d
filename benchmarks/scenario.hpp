#pragma once

#include <memory>
#include <string>
#include <vector>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/scene/scene.hpp"

namespace softfinger {

/// A finger on a path over objects, one pose a step.
struct Scenario {
  std::shared_ptr<const FingerModel> model;
  std::vector<VirtualObject> objects;
  double time_step = 1e-3;  ///< s
  std::vector<Pose> path;   ///< X_WFt at the start, then at the end of each step

  [[nodiscard]] std::size_t steps() const { return path.size() - 1; }
};

/// A shipped scene's script with a shipped finger; from `begin` to `end` (s) where these cut it.
[[nodiscard]] Scenario scripted(const std::string& scene, const std::string& finger,
                                double time_step, double begin = 0.0, double end = 1e9);
/// The fingers of the shipped hand, each on its own script, all of one length.
[[nodiscard]] std::vector<Scenario> shipped_hand(double time_step);
/// The soak test's violent motion on the shipped edge, rounded by 1 mm: a tracked pose that jumps,
/// followed no faster than 1 m/s by any point within 15 mm of it.
[[nodiscard]] Scenario violent_on_edge(const std::string& finger, double time_step, int steps);
/// The same path with contact at the samples only, and each element's own change of volume,
/// with constants at which that does not lock: what the plain step knows.
[[nodiscard]] Scenario plain(Scenario scenario);
/// The same path without friction.
[[nodiscard]] Scenario frictionless(Scenario scenario);

}  // namespace softfinger
