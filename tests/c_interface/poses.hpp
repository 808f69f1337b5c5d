#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>

#include "../support/folders.hpp"
#include "softfinger/geometry/pose.hpp"
#include "softfinger/softfinger.h"

namespace softfinger {

inline std::filesystem::path shipped_scene(const char* name) {
  return std::filesystem::path(source_folder()) / "scenes" / name;
}

/// One second on scenes/plane.toml: down to 3 mm below where the pad touches, tipping, and up.
inline sf_pose touching_pose(double time) {
  const double down = 2.0 * std::min(time, 1.0 - time);
  const Eigen::Quaterniond q(
      Eigen::AngleAxisd(0.1 + 0.1 * down, Vector3(0.3, 1.0, 0.0).normalized()));
  return {sizeof(sf_pose), {1e-3 * down, 0.0, 9e-3 - 3.5e-3 * down}, {q.w(), q.x(), q.y(), q.z()}};
}

inline Pose as_cpp(const sf_pose& pose) {
  const auto& q = pose.quaternion_wxyz;
  return {Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix(),
          Vector3(pose.position_m)};
}

/// The message of the last call on the handle that was refused.
inline std::string message_of(const sf_rendering* rendering) {
  char text[256];
  sf_rendering_message(rendering, text, sizeof text);
  return text;
}

/// A rendering of a shipped scene; ends with it.
class OpenedScene {
 public:
  explicit OpenedScene(const char* scene, const sf_options* options = nullptr) {
    char error[512];
    if (sf_rendering_create(shipped_scene(scene).c_str(), options, &rendering_, error,
                            sizeof error) != SF_DONE) {
      throw std::runtime_error(error);
    }
  }
  ~OpenedScene() { sf_rendering_destroy(rendering_); }
  OpenedScene(const OpenedScene&) = delete;
  OpenedScene& operator=(const OpenedScene&) = delete;
  operator sf_rendering*() const { return rendering_; }  // NOLINT(google-explicit-constructor)

 private:
  sf_rendering* rendering_ = nullptr;
};

}  // namespace softfinger
