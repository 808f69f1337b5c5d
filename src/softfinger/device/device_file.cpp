#include "softfinger/device/device_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/base/config_file.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/device/device_kinds.hpp"
#include "softfinger/device/transport_file.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

struct DeviceKind {
  const char* name;
  std::shared_ptr<const Device> (*read)(const ConfigFile& file, DeviceSettings settings);
  /// What a file must say at least; the schema is what the reader asks of it. Null: any keys.
  const char* example = nullptr;
};

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
    DeviceKind{"mechanism", read_mechanism},
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

std::shared_ptr<const Device> read_kind(const ConfigFile& file) {
  DeviceSettings settings;
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

/// Schema of `[transport]`: one alternative for each of its kinds.
Json transport_schema(const std::string& name, const std::string& text, const Device& device) {
  Json alternatives = Json::array();
  for (const std::string& kind : transport_kinds()) {
    const ConfigFile file(name + ".toml", text + transport_example(kind, device));
    static_cast<void>(read_kind(file));
    Json schema = Json::parse(file.schema())["properties"]["transport"];
    Json& properties = schema["properties"];
    add_meanings(kind, properties);
    add_meanings(kind, properties["servo"]["items"]["properties"]);
    properties["kind"] = {{"const", kind}};
    alternatives.push_back(schema);
  }
  return {{"anyOf", alternatives}};
}

}  // namespace

std::vector<std::string> device_kinds() {
  std::vector<std::string> names;
  names.reserve(kKinds.size());
  for (const DeviceKind& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

std::shared_ptr<const Device> load_device(const std::filesystem::path& path) {
  return read_kind(ConfigFile(path));
}

std::string device_schema(const std::string& name) {
  const DeviceKind& kind = kind_named(name);
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"title", "softfinger device file, " + name},
              {"type", "object"},
              {"properties", {{"kind", {{"const", name}}}}},
              {"required", {"kind"}}};
  if (kind.example == nullptr) return schema.dump(2);
  const std::string text = fmt::format("kind = \"{}\"\n{}", name, kind.example);
  const auto device = read_kind(ConfigFile(name + ".toml", text));
  // A field of more pins than there may be servos has no transport.
  const bool has_transport = device->joint_count() <= kMostServos;
  const ConfigFile file(name + ".toml",
                        has_transport ? text + transport_example("maestro", *device) : text);
  static_cast<void>(read_kind(file));
  schema.update(Json::parse(file.schema()));
  if (has_transport) {
    schema["properties"]["transport"] = transport_schema(name, text, *device);
  }
  schema["properties"]["kind"] = {{"const", name}};
  return schema.dump(2);
}

}  // namespace softfinger
