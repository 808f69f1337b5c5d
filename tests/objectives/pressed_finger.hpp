#pragma once

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/objectives/objective.hpp"

namespace softfinger {

inline constexpr double kTick = 1.0 / 30.0;  // s

/// The index finger, held on a plane with friction.
struct PressedFinger {
  explicit PressedFinger(double depth)
      : model(
            FingerModel::load(std::filesystem::path(source_folder()) / "fingers" / "index.toml")) {
    VirtualObject object;
    object.name = "plane";
    object.motion = Trajectory({Waypoint{}});
    FingerSimulation simulation(model, {&object, 1}, 1e-3);
    double lowest = 0.0;
    for (const Vector3& p : model->mesh.nodes) lowest = std::min(lowest, p.z());
    Pose X_WFt{Matrix3::Identity(), Vector3(0.0, 0.0, -lowest + 0.2 * mm)};
    simulation.reset(X_WFt);
    for (int step = 1; step <= 200; ++step) {
      X_WFt.translation.z() = std::max(-lowest - depth, X_WFt.translation.z() - 0.02 * mm);
      simulation.step(X_WFt, step * 1e-3);
    }
    contact = simulation.contact();
    nodes_W.assign(simulation.positions().begin(), simulation.positions().end());
    X_WF = simulation.bone_pose();
  }
  [[nodiscard]] VirtualFinger finger() const { return {contact, nodes_W, X_WF}; }

  std::shared_ptr<const FingerModel> model;
  ContactSet contact;
  std::vector<Vector3> nodes_W;
  Pose X_WF;
};

inline std::shared_ptr<const Device> device_of(const std::string& name) {
  return load_device(std::filesystem::path(source_folder()) / "devices" / (name + ".toml"));
}

}  // namespace softfinger
