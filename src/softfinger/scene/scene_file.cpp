#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/geometry/mesh_import.hpp"
#include "softfinger/geometry/mesh_units.hpp"
#include "softfinger/geometry/shape_names.hpp"
#include "softfinger/scene/object_dynamics_file.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/scene/scene_schema.hpp"
#include "softfinger/tracking/tracker_spec.hpp"

namespace softfinger {

namespace {

// Ranges in the units of the file: beyond them a number is a slip of the pen, and arithmetic on it
// would lose the micrometres that contact lives on.
const Range kSize{.min = 0.01, .max = 1e5};         // mm
const Range kPosition = Range::between(-1e5, 1e5);  // mm
const Range kRotation = Range::between(-1e4, 1e4);  // deg
const Range kTime = Range::between(0.0, 1e6);       // s
const Range kFriction = Range::between(0.0, 10.0);
const Range kSimulationRate = Range::between(100.0, 20000.0);  // Hz
constexpr double kDefaultEdgeRadius = 1.0 * mm;

const Range kEdgeRounding = Range::between(0.02, 10.0);  // mm
constexpr double kDefaultEdgeRounding = 0.25 * mm;

/// rotation_vector_deg may be left out, and position_mm where `fallback` has one.
Pose read_pose(const ConfigTable& table, const Pose* fallback) {
  Pose pose;
  if (fallback == nullptr) {
    pose.translation = table.numbers("position_mm", 3, kPosition);
  } else {
    pose.translation = table.numbers("position_mm", 3, kPosition, fallback->translation);
  }
  if (fallback != nullptr && !table.has("rotation_vector_deg")) {
    (void)table.numbers("rotation_vector_deg", 3, kRotation,
                        log_rotation(fallback->rotation));  // for the file as read
    pose.rotation = fallback->rotation;
  } else {
    const Vector3 turn = table.numbers("rotation_vector_deg", 3, kRotation, Vector3::Zero());
    pose.rotation = exp_rotation(turn);
  }
  return pose;
}

/// `[[waypoint]]` tables; `fallback`: the pose an object has where a waypoint does not say.
std::vector<Waypoint> read_waypoints(const ConfigTable& owner, const Pose* fallback) {
  std::vector<Waypoint> waypoints;
  for (const ConfigTable& table : owner.tables("waypoint")) {
    const double time = table.number("time_s", kTime);
    if (!waypoints.empty() && !(time > waypoints.back().time)) {
      table.fail("time_s", fmt::format("times of waypoints must increase, found {} after {}", time,
                                       waypoints.back().time));
    }
    waypoints.push_back({time, read_pose(table, fallback)});
  }
  return waypoints;
}

/// Default 1 mm, and at most `limit` (m), the least half size.
double read_edge_radius(const ConfigTable& table, double limit) {
  const double radius =
      table.number("edge_radius_mm", Range::at_least(0.0), std::min(kDefaultEdgeRadius, limit));
  if (radius > limit * (1.0 + 1e-9)) {
    table.fail("edge_radius_mm", fmt::format("must be at most the least half size, {:.6g}, found "
                                             "{:.6g}",
                                             limit / mm, radius / mm));
  }
  return std::min(radius, limit);
}

/// A mesh that an object names; loaded once the scene file is known to be right.
struct NamedMesh {
  ConfigTable table;
  std::size_t object;
  std::filesystem::path file;
  MeshShapeOptions options;
};

/// By their names, as mesh_format() has them.
constexpr const char* kGltfName = "\\.([gG][lL][tT][fF]|[gG][lL][bB])$";
constexpr const char* kOtherMeshName = "\\.([oO][bB][jJ]|[sS][tT][lL]|[pP][lL][yY])$";

double read_unit(const ConfigTable& table, const std::filesystem::path& file) {
  MeshFormat format;
  try {
    format = mesh_format(file);
  } catch (const InputError& error) {
    table.fail("file", error.what());
  }
  if (format == MeshFormat::kGltf || format == MeshFormat::kGlb) {
    table.matches("file", kGltfName);
    (void)table.choice("unit", {"m"}, "m");  // by definition
    return 1.0;
  }
  table.matches("file", kOtherMeshName);
  return row_named(kMeshUnits, table.choice("unit", names_of(kMeshUnits)))->value;
}

NamedMesh read_mesh(const ConfigTable& table, std::size_t object) {
  const std::filesystem::path file = table.path("file");
  return {.table = table,
          .object = object,
          .file = file,
          .options = {.unit = read_unit(table, file),
                      .edge_rounding =
                          table.number("edge_rounding_mm", kEdgeRounding, kDefaultEdgeRounding)}};
}

/// Objects of the same mesh share it.
void load_meshes(const std::vector<NamedMesh>& meshes, Scene& scene, const LoadObserver& observer) {
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const NamedMesh& mesh = meshes[i];
    Shape& shape = scene.objects[mesh.object].shape;
    const auto same =
        std::find_if(meshes.begin(), meshes.begin() + static_cast<std::ptrdiff_t>(i),
                     [&](const NamedMesh& other) {
                       return other.file == mesh.file && other.options.unit == mesh.options.unit &&
                              other.options.edge_rounding == mesh.options.edge_rounding;
                     });
    if (same != meshes.begin() + static_cast<std::ptrdiff_t>(i)) {
      shape = scene.objects[same->object].shape;
      continue;
    }
    try {
      shape = load_mesh_shape(mesh.file, mesh.options, observer);
    } catch (const InputError& error) {
      mesh.table.fail("file", error.what());
    }
  }
}

ShapeKind read_shape_kind(const ConfigTable& table) {
  return row_named(kShapes, table.choice("shape", names_of(kShapes)))->value;
}

/// A mesh is loaded later; until then its object is a plane.
Shape read_shape(const ConfigTable& table, ShapeKind kind) {
  if (kind == ShapeKind::kPlane || kind == ShapeKind::kMesh) return HalfSpace{};
  if (kind == ShapeKind::kSphere) return Ball{table.number("radius_mm", kSize)};
  if (kind == ShapeKind::kBox) {
    const Vector3 half_size = 0.5 * table.numbers("size_mm", 3, kSize);
    return RoundedBox{half_size, read_edge_radius(table, half_size.minCoeff())};
  }
  const double radius = table.number("radius_mm", kSize);
  const double half_length = 0.5 * table.number("length_mm", kSize);
  return RoundedCylinder{radius, half_length,
                         read_edge_radius(table, std::min(radius, half_length))};
}

/// shape, shape_2, shape_3, ... whichever is free.
std::string free_name(std::string_view shape, const std::set<std::string>& taken) {
  std::string name(shape);
  for (int k = 2; taken.contains(name); ++k) name = fmt::format("{}_{}", shape, k);
  return name;
}

VirtualObject read_object(const ConfigTable& table, const std::string& default_name,
                          std::optional<ReadDynamics>& dynamics) {
  const ShapeKind kind = read_shape_kind(table);
  VirtualObject object{.name = table.text("name", default_name),
                       .shape = read_shape(table, kind),
                       .motion = Trajectory(),
                       .friction_coefficient = {}};
  const Pose origin;
  const Pose X_WO = read_pose(table, &origin);
  object.friction_coefficient = table.optional_number("friction_coefficient", kFriction);
  dynamics = read_dynamics(table, kind == ShapeKind::kPlane);
  std::vector<Waypoint> waypoints;
  if (!dynamics) waypoints = read_waypoints(table, &X_WO);
  object.motion = waypoints.empty() ? Trajectory(X_WO) : Trajectory(std::move(waypoints));
  return object;
}

SceneFinger read_finger(const ConfigTable& table, bool trackers_given) {
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
  TrackerSpec tracker;
  try {
    tracker = parse_tracker_spec(finger.tracker);
  } catch (const InputError& error) {
    table.fail("tracker", error.what());
  }
  finger.waypoints = read_waypoints(table, nullptr);
  if (tracker.kind == TrackerKind::kScript && finger.waypoints.empty() && !trackers_given) {
    table.finish();  // a misspelt key may be the reason
    table.fail("tracker", "tracker script needs at least one [[finger.waypoint]]");
  }
  return finger;
}

/// All of a scene file but the meshes that it names.
struct ReadScene {
  Scene scene;
  std::vector<std::pair<std::size_t, ReadDynamics>> dynamics;
  std::vector<NamedMesh> meshes;
};

ReadScene read_scene(const ConfigFile& config, bool trackers_given) {
  const ConfigTable root = config.root();
  ReadScene read;
  Scene& scene = read.scene;
  scene.file = config.file();
  scene.description = root.text("description", "");
  const auto fingers = root.tables("finger");
  const auto objects = root.tables("object");
  const ConfigTable rates = root.table_or_empty("rates");
  scene.simulation_rate = rates.number("simulation_Hz", kSimulationRate, scene.simulation_rate);
  scene.gravity = root.table_or_empty("world").numbers(
      "gravity_m_per_s2", 3, Range::between(-100.0, 100.0), scene.gravity);
  std::set<std::string> names;
  for (const ConfigTable& table : fingers) {
    scene.fingers.push_back(read_finger(table, trackers_given));
    if (!names.insert(scene.fingers.back().name).second) {
      table.fail("name", fmt::format("two fingers are named '{}'", scene.fingers.back().name));
    }
  }
  // Given names first: a default must not take the name that a later object bears.
  names.clear();
  for (const ConfigTable& table : objects) {
    if (!table.has("name")) continue;
    const std::string name = table.text("name");
    if (name.empty()) table.fail("name", "expected a name, found an empty text");
    if (!names.insert(name).second) {
      table.fail("name", fmt::format("two objects are named '{}'", name));
    }
  }
  for (const ConfigTable& table : objects) {
    const ShapeKind kind = read_shape_kind(table);
    table.decides("shape");
    if (kind == ShapeKind::kMesh) read.meshes.push_back(read_mesh(table, scene.objects.size()));
    std::optional<ReadDynamics> dynamics;
    scene.objects.push_back(
        read_object(table, free_name(row_of(kShapes, kind).name, names), dynamics));
    if (dynamics) read.dynamics.emplace_back(scene.objects.size() - 1, *dynamics);
    if (read.dynamics.size() > kMostMovingObjects) {
      table.fail("motion", fmt::format("at most {} objects can be dynamic", kMostMovingObjects));
    }
    names.insert(scene.objects.back().name);
  }
  root.finish();  // first: a misspelt key may be the reason that there is no finger
  if (fingers.empty() && read.dynamics.empty()) {
    root.fail("finger", "a scene needs at least one [[finger]]");
  }
  return read;
}

/// With every key and every kind of object.
constexpr const char* kExample = R"toml(
[[finger]]
name = "index"
model = "index.toml"
device = "thimble-3rrs.toml"
[[finger.waypoint]]
time_s = 0.0
position_mm = [0.0, 0.0, 40.0]
)toml";
constexpr std::array kExampleObjects{
    "shape = \"plane\"\n",
    "shape = \"sphere\"\nradius_mm = 20.0\n",
    "shape = \"box\"\nsize_mm = [60.0, 60.0, 20.0]\n",
    "shape = \"cylinder\"\nradius_mm = 10.0\nlength_mm = 40.0\n",
    "shape = \"mesh\"\nfile = \"relief.ply\"\nunit = \"mm\"\n",
    "shape = \"mesh\"\nfile = \"relief.glb\"\n",
    "shape = \"box\"\nsize_mm = [60.0, 60.0, 20.0]\nmotion = \"dynamic\"\nmass_g = 10.0\n"
    "[object.joint]\nkind = \"slider\"\naxis = [0.0, 0.0, 1.0]\n"
    "[object.joint.curve]\ntravel_mm = [0.0, 1.0]\nforce_N = [0.0, 1.0]\n",
    "shape = \"cylinder\"\nradius_mm = 10.0\nlength_mm = 40.0\nmotion = \"dynamic\"\n"
    "density_kg_per_m3 = 1000.0\n[object.joint]\nkind = \"hinge\"\naxis = [0.0, 0.0, 1.0]\n"
    "parent = \"box\"\n[object.joint.detents]\ncount = 24\ntorque_N_mm = 4.0\n",
    "shape = \"sphere\"\nradius_mm = 20.0\nmotion = \"dynamic\"\nmass_g = 10.0\n"
    "[object.joint]\nkind = \"ball\"\n",
    "shape = \"mesh\"\nfile = \"relief.ply\"\nunit = \"mm\"\nmotion = \"dynamic\"\nmass_g = 10.0\n"
    "[object.joint]\nkind = \"fixed\"\n",
};

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
  const ConfigFile config(file);
  ReadScene read = read_scene(config, trackers_given);
  load_meshes(read.meshes, read.scene, observer);
  finish_dynamics(read.dynamics, read.scene.objects);
  return std::move(read.scene);
}

std::string scene_schema() {
  std::string text = kExample;
  for (const char* object : kExampleObjects) {
    const bool moves = std::string_view(object).find("dynamic") != std::string_view::npos;
    text +=
        fmt::format("[[object]]\n{}{}", object, moves ? "" : "[[object.waypoint]]\ntime_s = 0.0\n");
  }
  const ConfigFile config("scene.toml", text);
  static_cast<void>(read_scene(config, false));
  return config.schema("softfinger scene file");
}

}  // namespace softfinger
