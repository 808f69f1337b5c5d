#include "softfinger/device/device_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/device/device_kinds.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/motors/motor_kinds.hpp"
#include "softfinger/motors/transport_file.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

struct DeviceKind {
  const char* name;
  std::shared_ptr<const Device> (*read)(const ConfigFile& file, DeviceSettings settings);
  /// What a file must say at least; the schema is what the reader asks of it.
  const char* example;
  /// Of a kind whose files may describe what cannot be built: asks for the same keys.
  DeviceSettings (*read_keys)(const ConfigFile& file, DeviceSettings settings) = nullptr;
};

/// Every kind of body, joint, loop, surface and coordinate; MOTOR and RATE are of what drives it.
constexpr const char* kMechanism = R"toml(
[[body]]
name = "crank"
[[body]]
name = "rocker"
[[body]]
name = "slide"
[[body]]
name = "gimbal"
[[body]]
name = "ball"
[[body]]
name = "cage"
[[body]]
name = "weld"
[[body]]
name = "motor"
[[joint]]
name = "crank"
type = "revolute"
parent = "base"
child = "crank"
[[joint]]
name = "slide"
type = "prismatic"
parent = "crank"
child = "slide"
[[joint]]
name = "rocker"
type = "revolute"
parent = "slide"
child = "rocker"
[[joint]]
name = "gimbal"
type = "universal"
parent = "rocker"
child = "gimbal"
[[joint]]
name = "ball"
type = "spherical"
parent = "gimbal"
child = "ball"
[[joint]]
name = "cage"
type = "free"
parent = "base"
child = "cage"
[[joint]]
name = "weld"
type = "fixed"
parent = "ball"
child = "weld"
[[joint]]
name = "motor"
MOTOR
actuated = true
parent = "base"
child = "motor"
[[loop]]
type = "spherical"
body_a = "weld"
body_b = "cage"
[[loop]]
type = "revolute"
body_a = "weld"
body_b = "cage"
[[loop]]
type = "universal"
body_a = "weld"
body_b = "cage"
[[loop]]
type = "prismatic"
body_a = "weld"
body_b = "cage"
[[loop]]
type = "cylindrical"
body_a = "weld"
body_b = "cage"
[[loop]]
type = "fixed"
body_a = "weld"
body_b = "cage"
[[surface]]
type = "disk"
body = "cage"
radius_mm = 8.0
[[surface]]
type = "sphere"
body = "cage"
radius_mm = 8.0
[[surface]]
type = "capsule"
body = "cage"
radius_mm = 4.0
length_mm = 8.0
[[surface]]
type = "box"
body = "cage"
size_mm = [4.0, 4.0, 4.0]
[[surface]]
type = "pins"
body = "cage"
radius_mm = 0.5
rows = 2
columns = 2
pitch_mm = 2.0
[[surface]]
type = "pins"
body = "cage"
radius_mm = 0.5
[[surface.pin]]
position_mm = [0.0, 0.0, 0.0]
[[surface]]
type = "mesh"
body = "cage"
file = "cap.stl"
unit = "mm"
[[surface]]
type = "mesh"
body = "cage"
file = "cap.glb"
unit = "m"
[configuration]
crank_deg = { joint = "crank" }
slide_mm = { joint = "slide" }
gimbal_deg = { joint = "gimbal", coordinate = "first" }
pitch_deg = { body = "cage", coordinate = "pitch" }
z_mm = { body = "cage", coordinate = "z" }
[limits]
RATE
max_tilt_deg = 30.0
tilt_body = "cage"
[matching]
approach = "z_mm"
)toml";

constexpr std::array kKinds{
    DeviceKind{"platform_3rrs", read_platform_3rrs, R"toml(
[geometry]
base_radius_mm = 12.0
platform_radius_mm = 12.0
crank_mm = 12.0
coupler_mm = 24.0
neutral_height_mm = 28.0
disk_radius_mm = 8.0
[limits]
joint_deg = [-30.0, 75.0]
joint_rate_deg_per_s = 400.0
)toml"},
    DeviceKind{"plate_2dof", read_plate_2dof, R"toml(
[geometry]
lever_mm = 6.0
pinion_radius_mm = 6.0
disk_radius_mm = 8.0
[limits]
joint_deg = [-60.0, 100.0]
joint_rate_deg_per_s = 400.0
)toml"},
    DeviceKind{"cable_platform", read_cable_platform, R"toml(
[geometry]
base_radius_mm = 14.0
platform_radius_mm = 11.0
neutral_height_mm = 24.0
winch_radius_mm = 5.0
spring_length_mm = 32.0
spring_N_per_mm = 0.05
disk_radius_mm = 8.0
[limits]
joint_deg = [-120.0, 150.0]
joint_rate_deg_per_s = 400.0
)toml"},
    DeviceKind{"pin_array", read_pin_array, R"toml(
[geometry]
rows = 16
columns = 16
pitch_mm = 2.0
pin_radius_mm = 0.5
stroke_mm = 2.0
)toml"},
    DeviceKind{"delta_tactor", read_delta_tactor, R"toml(
[geometry]
base_radius_mm = 12.0
platform_radius_mm = 4.0
crank_mm = 10.0
forearm_mm = 20.0
neutral_height_mm = 17.0
tip_radius_mm = 3.0
[limits]
joint_deg = [-40.0, 100.0]
joint_rate_deg_per_s = 400.0
)toml"},
    DeviceKind{"membrane", read_membrane, R"toml(
[geometry]
ring_radius_mm = 7.0
[limits]
height_mm = [0.0, 4.0]
)toml"},
    DeviceKind{"roller", read_roller, R"toml(
[geometry]
roller_radius_mm = 5.0
roller_length_mm = 10.0
[limits]
position_mm = [-6.0, 6.0]
height_mm = [-4.0, 7.0]
)toml"},
    DeviceKind{"mechanism", read_mechanism, kMechanism, read_mechanism_keys},
};

const DeviceKind& kind_named(const std::string& name) {
  const auto found = std::find_if(kKinds.begin(), kKinds.end(),
                                  [&](const DeviceKind& kind) { return name == kind.name; });
  if (found != kKinds.end()) return *found;
  const std::string near = nearest_word(name, device_kinds());
  throw InputError(fmt::format("unknown kind '{}'; {}expected one of: {}", name,
                               near.empty() ? "" : fmt::format("did you mean '{}'? ", near),
                               fmt::join(device_kinds(), ", ")));
}

std::shared_ptr<const Device> read_kind(const ConfigFile& file, double mount_shift = 0.0) {
  DeviceSettings settings;
  settings.mount_shift = mount_shift;
  settings.kind = file.root().choice("kind", device_kinds());
  const DeviceKind& kind = kind_named(settings.kind);
  return kind.read(file, std::move(settings));
}

void add_meanings(std::string_view kind, Json& properties) {
  for (auto& [key, schema] : properties.items()) {
    const std::string_view meaning = transport_key_meaning(kind, key);
    if (!meaning.empty()) schema["description"] = meaning;
  }
}

/// What there may be in every device file.
constexpr const char* kForceSensor = "[force_sensor]\nkind = \"emulator\"\n";

DeviceSettings read_keys(const ConfigFile& file) {
  DeviceSettings settings;
  settings.kind = file.root().choice("kind", device_kinds());
  file.root().decides("kind");
  const DeviceKind& kind = kind_named(settings.kind);
  if (kind.read_keys != nullptr) return kind.read_keys(file, std::move(settings));
  return kind.read(file, std::move(settings))->settings();
}

/// Schema of `[transport]`: one alternative for each of its kinds.
Json transport_schema(const std::string& text, const JointLimits& limits) {
  Json alternatives = Json::array();
  for (const std::string& kind : transport_kinds()) {
    const ConfigFile file("device.toml", text + transport_example(kind, limits));
    static_cast<void>(read_keys(file));
    Json schema = Json::parse(file.schema(""))["properties"]["transport"];
    Json& properties = schema["properties"];
    add_meanings(kind, properties);
    add_meanings(kind, properties["servo"]["items"]["properties"]);
    alternatives.push_back(schema);
  }
  return {{"anyOf", alternatives}};
}

std::string with_words(std::string text, const std::string& word, const std::string& by) {
  return text.replace(text.find(word), word.size(), by);
}

/// Schema of the files that are like this example.
Json example_schema(const std::string& name, const std::string& example) {
  const std::string text = fmt::format("kind = \"{}\"\n{}{}", name, example, kForceSensor);
  const ConfigFile file("device.toml", text);
  const DeviceSettings settings = read_keys(file);
  Json schema = Json::parse(file.schema("softfinger device file, " + name));
  JointLimits limits = settings.joint_limits;
  std::string driven = text;
  if (limits.min.size() > kMostServos) {  // a field of pins; one of few may have a transport
    driven = with_words(with_words(text, "rows = 16", "rows = 1"), "columns = 16", "columns = 1");
    limits.min.conservativeResize(1);
  }
  schema["properties"]["transport"] = transport_schema(driven, limits);
  return schema;
}

}  // namespace

std::vector<std::string> device_kinds() {
  std::vector<std::string> names;
  names.reserve(kKinds.size());
  for (const DeviceKind& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

std::shared_ptr<const Device> load_device(const std::filesystem::path& path, double mount_shift) {
  return read_kind(ConfigFile(path), mount_shift);
}

std::string device_schema(const std::string& name) {
  const DeviceKind& kind = kind_named(name);
  if (kind.read_keys == nullptr) return example_schema(name, kind.example).dump(2);
  // Its motors all turn or all slide, and keys go by that.
  const auto driven = [&](const std::string& motor, const std::string& rate) {
    return example_schema(name, with_words(with_words(kind.example, "MOTOR", motor), "RATE", rate));
  };
  const Json turning =
      driven("type = \"revolute\"\njoint_deg = [-30.0, 30.0]", "joint_rate_deg_per_s = 400.0");
  const Json sliding =
      driven("type = \"prismatic\"\njoint_mm = [-3.0, 3.0]", "joint_rate_mm_per_s = 50.0");
  return Json{
      {"$schema", turning["$schema"]}, {"title", turning["title"]}, {"anyOf", {turning, sliding}}}
      .dump(2);
}

}  // namespace softfinger
