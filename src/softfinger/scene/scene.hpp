#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/contact/virtual_object.hpp"
#include "softfinger/geometry/mesh_shape.hpp"
#include "softfinger/geometry/trajectory.hpp"

namespace softfinger {

/// A finger of the scene: which model, which device renders it, where its pose comes from.
struct SceneFinger {
  std::string name;
  std::filesystem::path model;                  ///< finger file, resolved
  std::optional<std::filesystem::path> device;  ///< device file, resolved
  std::string tracker = "script";               ///< as written: script, csv:FILE, ...
  std::vector<Waypoint> waypoints;              ///< X_WFt; only tracker "script" uses them
};

/// What one run explores. Built from a scene file (TOML, keys in docs/files.md).
struct Scene {
  std::filesystem::path file;
  std::string description;  ///< one line for people; may be empty
  std::vector<SceneFinger> fingers;
  std::vector<VirtualObject> objects;
  double simulation_rate = 1000.0;   ///< Hz
  Vector3 gravity{0.0, 0.0, -9.81};  ///< on objects that move by the forces on them, W, m/s^2
};

/// 1 to 64 letters, digits, - or _: names of fingers stand before the = of --device NAME=FILE, in
/// file names and in those of a person file's tables.
[[nodiscard]] bool is_finger_name(std::string_view name);

/// Reads and checks a scene file with the meshes of its objects, whose distance grids may take time
/// to build; the finger, device and pose files it names are not opened.
/// `trackers_given`: trackers are named elsewhere (`--tracker`), so a finger with tracker "script"
/// may do without waypoints. Throws InputError with file, line and key.
[[nodiscard]] Scene load_scene(const std::filesystem::path& file, bool trackers_given = false,
                               const LoadObserver& observer = {});
/// The same of a file's text at hand, which may differ from the file.
[[nodiscard]] Scene load_scene(const std::filesystem::path& file, const std::string& text,
                               bool trackers_given = false, const LoadObserver& observer = {});

}  // namespace softfinger
