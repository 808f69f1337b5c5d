#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "softfinger/device/device_file.hpp"
#include "softfinger/device/kinds/device_kinds.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/motors/motor_kinds.hpp"
#include "softfinger/motors/transport_file.hpp"

namespace softfinger {
namespace {

using Json = nlohmann::ordered_json;

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
  settings.kind = file.root().choice("kind", device_kind_names());
  file.root().decides("kind");
  const DeviceKind& kind = device_kind(settings.kind);
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
  const std::string bare = fmt::format("kind = \"{}\"\n{}{}", name, example, kForceSensor);
  const bool linear = read_keys(ConfigFile("device.toml", bare)).joint_limits.linear;
  const std::string text =
      fmt::format("{}[statics]\nbacklash_{} = 0.1\n", bare, linear ? "mm" : "deg");
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

std::string device_schema(const std::string& name) {
  const DeviceKind& kind = device_kind(name);
  if (std::string_view(kind.example).find("MOTOR") == std::string_view::npos)
    return example_schema(name, kind.example).dump(2);
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

std::string device_schema() {
  const std::vector<std::string> kinds = device_kind_names();
  Json any = Json::array();
  for (const std::string& kind : kinds) any.push_back(Json::parse(device_schema(kind)));
  return Json{{"$schema", any[0]["$schema"]},
              {"title", "softfinger device file"},
              {"properties", {{"kind", {{"enum", kinds}}}}},
              {"required", {"kind"}},
              {"anyOf", any}}
      .dump(2);
}

}  // namespace softfinger
