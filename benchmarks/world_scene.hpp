#pragma once

#include <memory>
#include <string>
#include <vector>

#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/session/run_objects.hpp"
#include "softfinger/world/world.hpp"

namespace softfinger {

/// A scene whose objects move by forces, stepped by its scripts as a run steps it, without devices.
class WorldScene {
 public:
  explicit WorldScene(Scene scene);
  /// One that is shipped.
  [[nodiscard]] static WorldScene shipped(const std::string& name);

  /// From the start, which it comes back to at the end of the scripts.
  void step();
  [[nodiscard]] const World& world() const { return *world_; }

 private:
  void reset();

  std::unique_ptr<Scene> scene_;
  std::unique_ptr<World> world_;
  std::unique_ptr<RunObjects> wanted_;
  std::vector<std::unique_ptr<Tracker>> trackers_;  ///< by finger
  std::vector<std::unique_ptr<FingerSimulation>> fingers_;
  std::vector<FingerSimulation*> all_;
  std::vector<StepSummary> summaries_;
  double duration_ = 0.0;  ///< s; 0: it never ends
  long step_ = 0;
};

}  // namespace softfinger
