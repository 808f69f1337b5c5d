#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/files/text_file.hpp"
#include "softfinger/scene/hand_file.hpp"
#include "softfinger/scene/object_file.hpp"
#include "softfinger/scene/pose_keys.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/scene/scene_schema.hpp"
#include "softfinger/tracking/tracker_spec.hpp"

namespace softfinger {

namespace {

const Range kSimulationRate = Range::between(100.0, 20000.0);  // Hz
const Range kGravity = Range::between(-100.0, 100.0);          // m/s^2

SceneFinger read_finger(const ConfigTable& table, const std::vector<ReadHand>& hands,
                        bool trackers_given) {
  SceneFinger finger;
  finger.name = table.text("name");
  table.matches("name", kFingerNamePattern);
  if (!is_finger_name(finger.name)) {
    table.fail("name", "expected 1 to 64 letters, digits, - or _");
  }
  finger.model = table.path("model");
  finger.device = table.optional_path("device");
  finger.tracker = table.text("tracker", "script");
  table.matches("tracker", fmt::format("^({})(:|$)", fmt::join(names_of(kTrackers), "|")));
  read_hand_of(table, hands, finger);
  TrackerSpec tracker;
  try {
    tracker = parse_tracker_spec(finger.tracker);
  } catch (const InputError& error) {
    table.fail("tracker", error.what());
  }
  finger.waypoints = read_waypoints(table, nullptr);
  if (tracker.kind == TrackerKind::kScript && finger.waypoints.empty() && !finger.hand_script &&
      !trackers_given) {
    table.finish();  // a misspelt key may be the reason
    table.fail("tracker", "tracker script needs at least one [[finger.waypoint]]");
  }
  return finger;
}

std::vector<SceneFinger> read_fingers(const std::vector<ConfigTable>& tables,
                                      const std::vector<ReadHand>& hands, bool trackers_given) {
  std::vector<SceneFinger> fingers;
  std::set<std::string> names;
  for (const ConfigTable& table : tables) {
    fingers.push_back(read_finger(table, hands, trackers_given));
    if (!names.insert(fingers.back().name).second) {
      table.fail("name", fmt::format("two fingers are named '{}'", fingers.back().name));
    }
    const SceneFinger& last = fingers.back();
    const auto same = [&](const SceneFinger& other) {
      return &other != &last && other.hand >= 0 && other.hand == last.hand &&
             other.hand_finger == last.hand_finger;
    };
    if (std::ranges::any_of(fingers, same)) {
      table.fail("hand", fmt::format("hand '{}' has two fingers that are its {}",
                                     hands[static_cast<std::size_t>(last.hand)].hand.name,
                                     name_of(last.hand_finger)));
    }
  }
  return fingers;
}

/// All of a scene file but what its objects' meshes tell.
struct ReadScene {
  Scene scene;
  std::vector<ReadObject> objects;
  std::vector<ReadHand> hands;
};

ReadScene read_scene(const ConfigFile& config, bool trackers_given, bool with_files = true) {
  const ConfigTable root = config.root();
  ReadScene read;
  Scene& scene = read.scene;
  scene.file = config.file();
  scene.description = root.text("description", "");
  const auto fingers = root.tables("finger");
  const auto objects = root.tables("object");
  const auto hands = root.tables("hand");
  const ConfigTable rates = root.table_or_empty("rates");
  scene.simulation_rate = rates.number("simulation_Hz", kSimulationRate, scene.simulation_rate);
  scene.gravity =
      root.table_or_empty("world").numbers("gravity_m_per_s2", 3, kGravity, scene.gravity);
  read.hands = read_hands(hands);
  scene.fingers = read_fingers(fingers, read.hands, trackers_given);
  read.objects = read_objects(objects, with_files);
  root.finish();  // first: a misspelt key may be the reason that there is no finger
  const bool moves = std::ranges::any_of(
      read.objects, [](const ReadObject& each) { return each.object.moves_by_forces(); });
  if (fingers.empty() && !moves && read.hands.empty()) {
    root.fail("finger",
              "a scene needs at least one [[finger]], or an object that is dynamic or soft");
  }
  return read;
}

constexpr const char* kExample = R"toml(
[[finger]]
name = "index"
model = "index.toml"
device = "thimble-3rrs.toml"
hand = "right"
[[finger.waypoint]]
time_s = 0.0
position_mm = [0.0, 0.0, 40.0]
[[hand]]
[[hand.waypoint]]
time_s = 0.0
position_mm = [0.0, 0.0, 40.0]
)toml";
constexpr const char* kExamplePlane = "shape = \"plane\"\n";
constexpr std::array kExampleSolids{
    "shape = \"sphere\"\nradius_mm = 20.0\n",
    "shape = \"box\"\nsize_mm = [60.0, 60.0, 20.0]\n",
    "shape = \"cylinder\"\nradius_mm = 10.0\nlength_mm = 40.0\n",
    "shape = \"mesh\"\nfile = \"relief.ply\"\nunit = \"mm\"\n",
    "shape = \"mesh\"\nfile = \"relief.glb\"\n",
};
constexpr const char* kExampleSoft =
    "shape = \"soft\"\nfile = \"sponge.msh\"\nunit = \"mm\"\n"
    "material = {youngs_modulus_kPa = 20.0, poissons_ratio = 0.3, density_kg_per_m3 = 200.0, "
    "foam = {}, relaxation = [{time_ms = 100.0, fraction = 0.5}]}\n"
    "strain_limits = {min = 0.5}\n";
constexpr std::array kExampleJoints{
    "kind = \"slider\"\naxis = [0.0, 0.0, 1.0]\n"
    "curve = {travel_mm = [0.0, 1.0], force_N = [0.0, 1.0]}\n",
    "kind = \"hinge\"\naxis = [0.0, 0.0, 1.0]\ndetents = {count = 24, torque_N_mm = 4.0}\n",
    "kind = \"ball\"\n",
    "kind = \"fixed\"\n",
};

/// With every key and every kind of object.
std::string example() {
  const auto scripted = [](const char* object) {
    return fmt::format("[[object]]\n{}[[object.waypoint]]\ntime_s = 0.0\n", object);
  };
  std::string text = kExample + scripted(kExamplePlane);
  for (const char* object : kExampleSolids) text += scripted(object);
  text += scripted(kExampleSoft);
  for (const char* object : kExampleSolids) {
    for (const char* joint : kExampleJoints) {
      text += fmt::format("[[object]]\n{}motion = \"dynamic\"\nmass_g = 1.0\n[object.joint]\n{}",
                          object, joint);
    }
  }
  return text;
}

}  // namespace

bool is_finger_name(std::string_view name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  };
  return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, allowed);
}

Scene load_scene(const std::filesystem::path& file, bool trackers_given,
                 const LoadObserver& observer) {
  return load_scene(file, read_text_file(file, ConfigFile::kMaxSize), trackers_given, observer);
}

Scene load_scene(const std::filesystem::path& file, const std::string& text, bool trackers_given,
                 const LoadObserver& observer) {
  const ConfigFile config(file, text);
  ReadScene read = read_scene(config, trackers_given);
  read.scene.objects = complete(read.objects, observer);
  add_hands(read.hands, read.scene);
  return std::move(read.scene);
}

std::string scene_schema() {
  const ConfigFile config("scene.toml", example());
  static_cast<void>(read_scene(config, false, false));
  return config.schema("softfinger scene file");
}

}  // namespace softfinger
