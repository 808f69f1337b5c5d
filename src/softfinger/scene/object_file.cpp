#include "softfinger/scene/object_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/geometry/mass_properties.hpp"
#include "softfinger/geometry/mesh_import.hpp"
#include "softfinger/geometry/mesh_units.hpp"
#include "softfinger/geometry/shape_names.hpp"
#include "softfinger/scene/joint_file.hpp"
#include "softfinger/scene/pose_keys.hpp"
#include "softfinger/scene/soft_file.hpp"

namespace softfinger {
namespace {

const Range kSize{.min = 0.01, .max = 1e5};  // mm
const Range kFriction = Range::between(0.0, 10.0);
constexpr double kDefaultEdgeRadius = 1.0 * mm;
const Range kEdgeRounding = Range::between(0.02, 10.0);  // mm
constexpr double kDefaultEdgeRounding = 0.25 * mm;

const Range kMass = Range::between(1e-3, 1e5);             // g
const Range kDensity = Range::between(1e-3, 1e6);          // kg/m^3
const Range kVelocity = Range::between(-1e5, 1e5);         // mm/s
const Range kAngularVelocity = Range::between(-1e5, 1e5);  // deg/s
constexpr int kMostDynamic = 64;
constexpr int kMostSoft = 8;

enum class Motion { kScripted, kDynamic };
constexpr std::array<NameRow<Motion>, 2> kMotions{{
    {Motion::kScripted, "scripted"},
    {Motion::kDynamic, "dynamic"},
}};
constexpr std::array kDynamicKeys{"mass_g", "density_kg_per_m3", "velocity_mm_per_s",
                                  "angular_velocity_deg_per_s", "joint"};

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

ReadObject::Mesh read_mesh(const ConfigTable& table) {
  const std::filesystem::path file = table.path("file");
  return {.file = file,
          .options = {.unit = read_unit(table, file),
                      .edge_rounding =
                          table.number("edge_rounding_mm", kEdgeRounding, kDefaultEdgeRounding)}};
}

/// Empty: it is soft.
std::optional<ShapeKind> read_shape_kind(const ConfigTable& table) {
  std::vector<std::string> names = object_shape_names();
  names.emplace_back(kSoftShape);
  const std::string name = table.choice("shape", names);
  if (name == kSoftShape) return std::nullopt;
  return row_named(kShapes, name)->value;
}

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

Motion read_motion(const ConfigTable& table) {
  const std::vector<std::string> names = names_of(kMotions);
  // Where it is given it tells one kind of object from the other.
  const std::string name =
      table.has("motion") ? table.choice("motion", names)
                          : table.choice("motion", names, row_of(kMotions, Motion::kScripted).name);
  table.decides("motion");
  return row_named(kMotions, name)->value;
}

Trajectory read_script(const ConfigTable& table, const Pose& X_WO) {
  for (const char* key : kDynamicKeys) {
    if (table.has(key)) table.fail(key, "is of an object with motion = \"dynamic\" alone");
  }
  auto waypoints = read_waypoints(table, &X_WO);
  return waypoints.empty() ? Trajectory(X_WO) : Trajectory(std::move(waypoints));
}

/// Either is filled in.
void read_mass(const ConfigTable& table, double& mass, std::optional<double>& density) {
  const auto given = table.optional_number("mass_g", kMass);
  density = table.optional_number("density_kg_per_m3", kDensity);
  if (given && density) {
    table.fail("density_kg_per_m3", "stands instead of mass_g; leave one out");
  }
  if (!given && !density) {
    // A misspelt key may be the reason.
    for (const std::string& key : table.keys()) {
      const std::string near = nearest_word(key, {"mass_g", "density_kg_per_m3"});
      if (near.empty()) continue;
      table.fail(key, fmt::format("unknown key '{}'; did you mean '{}'?", key, near));
    }
    table.fail("mass_g", "missing; a dynamic object needs mass_g or density_kg_per_m3");
  }
  mass = given.value_or(0.0);
}

void read_dynamics(const ConfigTable& table, ShapeKind kind, ReadObject& read) {
  if (kind == ShapeKind::kPlane) {
    table.fail("motion", "a plane has no end and no mass: it cannot be dynamic");
  }
  if (table.has("waypoint")) {
    table.fail("waypoint", "a dynamic object moves by the forces on it; leave waypoints out");
  }
  ObjectDynamics& dynamics = read.object.dynamics.emplace();
  read_mass(table, dynamics.mass, read.density);
  const Vector3 still = Vector3::Zero();
  dynamics.velocity_W = table.numbers("velocity_mm_per_s", 3, kVelocity, still);
  dynamics.angular_velocity_W =
      table.numbers("angular_velocity_deg_per_s", 3, kAngularVelocity, still);
  if (const auto joint = table.optional_table("joint")) {
    (void)joint->optional_text("parent");  // known when all objects are
    dynamics.joint = read_joint(*joint);
  }
}

/// What is soft moves by the forces on it, but for what is held.
ReadObject read_soft_object(const ConfigTable& table, const std::set<std::string>& taken,
                            bool with_files) {
  ReadObject read{.table = table,
                  .object = {.name = table.text("name", free_name(kSoftShape, taken)),
                             .shape = HalfSpace{},
                             .motion = Trajectory(),
                             .friction_coefficient = {}},
                  .mesh = {},
                  .density = {}};
  read.object.soft = read_soft(table, with_files);
  const Pose origin;
  const Pose X_WO = read_pose(table, &origin);
  read.object.friction_coefficient = table.optional_number("friction_coefficient", kFriction);
  (void)table.choice("motion", names_of(kMotions), row_of(kMotions, Motion::kDynamic).name);
  for (const char* key : kDynamicKeys) {
    if (table.has(key)) {
      table.fail(key, "a soft object moves by the density of its material; leave this out");
    }
  }
  if (table.has("waypoint") && with_files && !read.object.soft->is_held()) {
    table.fail("waypoint", "the mesh has no physical surface 'fixed' that could follow waypoints");
  }
  auto waypoints = read_waypoints(table, &X_WO);
  read.object.motion = waypoints.empty() ? Trajectory(X_WO) : Trajectory(std::move(waypoints));
  return read;
}

ReadObject read_object(const ConfigTable& table, const std::set<std::string>& taken,
                       bool with_files) {
  const std::optional<ShapeKind> given = read_shape_kind(table);
  table.decides("shape");
  if (!given) return read_soft_object(table, taken, with_files);
  const ShapeKind kind = *given;
  std::optional<ReadObject::Mesh> mesh;
  if (kind == ShapeKind::kMesh) mesh = read_mesh(table);
  const std::string name = table.text("name", free_name(row_of(kShapes, kind).name, taken));
  ReadObject read{.table = table,
                  .object = {.name = name,
                             .shape = read_shape(table, kind),
                             .motion = Trajectory(),
                             .friction_coefficient = {}},
                  .mesh = std::move(mesh),
                  .density = {}};
  const Pose origin;
  const Pose X_WO = read_pose(table, &origin);
  read.object.friction_coefficient = table.optional_number("friction_coefficient", kFriction);
  if (read_motion(table) == Motion::kScripted) {
    read.object.motion = read_script(table, X_WO);
  } else {
    read.object.motion = Trajectory(X_WO);
    read_dynamics(table, kind, read);
  }
  return read;
}

std::set<std::string> given_names(const std::vector<ConfigTable>& tables) {
  std::set<std::string> names;
  for (const ConfigTable& table : tables) {
    if (!table.has("name")) continue;
    const std::string name = table.text("name");
    if (name.empty()) table.fail("name", "expected a name, found an empty text");
    if (!names.insert(name).second) {
      table.fail("name", fmt::format("two objects are named '{}'", name));
    }
  }
  return names;
}

int number_of(const std::string& name, const std::vector<VirtualObject>& objects,
              const ConfigTable& joint) {
  const auto found = std::ranges::find(objects, name, &VirtualObject::name);
  if (found != objects.end()) return static_cast<int>(found - objects.begin());
  std::vector<std::string> names;
  names.reserve(objects.size());
  for (const VirtualObject& object : objects) names.push_back(object.name);
  const std::string near = nearest_word(name, names);
  joint.fail("parent", fmt::format("no object is named '{}'{}", name,
                                   near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
}

int parent_of(const VirtualObject& object) {
  return object.dynamics && object.dynamics->joint ? object.dynamics->joint->parent : -1;
}

void join(const std::vector<ReadObject>& read, std::vector<VirtualObject>& objects) {
  for (std::size_t i = 0; i < read.size(); ++i) {
    if (!objects[i].dynamics || !objects[i].dynamics->joint) continue;
    const ConfigTable table = read[i].table.table("joint");
    const auto parent = table.optional_text("parent");
    if (!parent) continue;
    const int number = number_of(*parent, objects, table);
    if (objects[static_cast<std::size_t>(number)].soft) {
      table.fail("parent", fmt::format("'{}' is soft: nothing can hang on it", *parent));
    }
    if (number == static_cast<int>(i)) {
      table.fail("parent", fmt::format("'{}' is the object itself", *parent));
    }
    objects[i].dynamics->joint->parent = number;
    // Whose parents are known so far leads back here where this one closes a loop.
    for (int p = number; p >= 0; p = parent_of(objects[static_cast<std::size_t>(p)])) {
      if (p == static_cast<int>(i)) {
        table.fail("parent",
                   fmt::format("joints make a loop: '{}' hangs on '{}', which hangs on it",
                               objects[i].name, *parent));
      }
    }
  }
}

void load_meshes(const std::vector<ReadObject>& read, std::vector<VirtualObject>& objects,
                 const LoadObserver& observer) {
  for (std::size_t i = 0; i < read.size(); ++i) {
    if (!read[i].mesh) continue;
    const ReadObject::Mesh& mesh = *read[i].mesh;
    const auto same = std::find_if(read.begin(), read.end(), [&](const ReadObject& other) {
      return other.mesh && other.mesh->file == mesh.file &&
             other.mesh->options.unit == mesh.options.unit &&
             other.mesh->options.edge_rounding == mesh.options.edge_rounding;
    });
    const auto first = static_cast<std::size_t>(same - read.begin());
    if (first < i) {
      objects[i].shape = objects[first].shape;
      continue;
    }
    try {
      objects[i].shape = load_mesh_shape(mesh.file, mesh.options, observer);
    } catch (const InputError& error) {
      read[i].table.fail("file", error.what());
    }
  }
}

void weigh(const ReadObject& read, VirtualObject& object) {
  if (!object.dynamics) return;
  const auto properties = mass_properties(object.shape);
  if (!properties || !(properties->volume > 0.0)) {
    read.table.fail("motion", "the shape has no volume, so it cannot be dynamic");
  }
  if (!read.density) return;
  object.dynamics->mass = *read.density * properties->volume;
  const double mass_g = object.dynamics->mass / unit_scale("mass_g");
  if (mass_g < kMass.min || mass_g > kMass.max) {
    read.table.fail("density_kg_per_m3",
                    fmt::format("makes a mass of {:.3g} g; it must be {:g} to {:g}", mass_g,
                                kMass.min, kMass.max));
  }
}

}  // namespace

std::vector<ReadObject> read_objects(const std::vector<ConfigTable>& tables, bool with_files) {
  // Given names first: a default must not take the name that a later object bears.
  std::set<std::string> names = given_names(tables);
  std::vector<ReadObject> read;
  int dynamic = 0;
  int soft = 0;
  for (const ConfigTable& table : tables) {
    read.push_back(read_object(table, names, with_files));
    names.insert(read.back().object.name);
    if (read.back().object.soft && ++soft > kMostSoft) {
      table.fail("shape", fmt::format("more than {} soft objects", kMostSoft));
    }
    if (!read.back().object.dynamics) continue;
    if (++dynamic > kMostDynamic) {
      table.fail("motion", fmt::format("more than {} dynamic objects", kMostDynamic));
    }
  }
  return read;
}

std::vector<VirtualObject> complete(const std::vector<ReadObject>& read,
                                    const LoadObserver& observer) {
  std::vector<VirtualObject> objects;
  objects.reserve(read.size());
  for (const ReadObject& each : read) objects.push_back(each.object);
  join(read, objects);
  load_meshes(read, objects, observer);
  for (std::size_t i = 0; i < read.size(); ++i) weigh(read[i], objects[i]);
  return objects;
}

}  // namespace softfinger
