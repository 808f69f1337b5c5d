#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/contact/virtual_object.hpp"
#include "softfinger/geometry/mesh_shape.hpp"
#include "softfinger/geometry/trajectory.hpp"
#include "softfinger/tracking/hand_script.hpp"

namespace softfinger {

/// A finger of the scene: which model, which device renders it, where its pose comes from.
struct SceneFinger {
  std::string name;
  std::filesystem::path model;                  ///< finger file, resolved
  std::optional<std::filesystem::path> device;  ///< device file, resolved
  std::string tracker = "script";               ///< as written: script, csv:FILE, ...
  std::vector<Waypoint> waypoints;              ///< X_WFt; only tracker "script" uses them
  int hand = -1;                                ///< whose finger it is, by number; -1: none's
  HandFinger hand_finger = HandFinger::kIndex;  ///< which of it
  /// Its hand's, which tracker "script" follows instead of waypoints; empty: there is none.
  std::optional<HandScript> hand_script = {};

  /// The tracker that is named, files in it relative to `directory`. Throws as make_tracker() of
  /// tracking does.
  [[nodiscard]] std::unique_ptr<Tracker> make_tracker(const std::filesystem::path& directory) const;
};

/// A whole hand of the scene. Its bones, but for the distal phalanges, are objects.
struct SceneHand {
  std::string name;
  HandSide side = HandSide::kRight;
  std::optional<HandScript> script;  ///< empty: a headset tracks it
  std::size_t first_object = 0;      ///< the object that is the first of kHandPieces
};

struct Scene;
/// The hand of this number follows a headset, and is nowhere before that sees it.
void leave_to_headset(Scene& scene, std::size_t hand);

/// What one run explores. Built from a scene file (TOML, keys in docs/files.md).
struct Scene {
  std::filesystem::path file;
  std::string description;  ///< one line for people; may be empty
  std::vector<SceneFinger> fingers;
  std::vector<VirtualObject> objects;  ///< those of hands come last
  std::vector<SceneHand> hands;
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
