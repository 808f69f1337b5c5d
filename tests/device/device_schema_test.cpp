#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "kinds.hpp"
#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

using nlohmann::json;

/// Where `value` breaks the schema; empty where it does not. As much of JSON Schema as a device's
/// has: type, properties, required, additionalProperties, enum, const, bounds, items, anyOf.
std::string breach(const json& schema, const json& value, const std::string& at = "") {
  if (schema.contains("anyOf")) {
    for (const json& choice : schema["anyOf"]) {
      if (breach(choice, value, at).empty()) return {};
    }
    return at + ": none of several";
  }
  if (schema.contains("const") && value != schema["const"]) return at + ": not the constant";
  if (schema.contains("enum") &&
      std::find(schema["enum"].begin(), schema["enum"].end(), value) == schema["enum"].end()) {
    return at + ": not one of the words";
  }
  const std::string type = schema.value("type", "");
  if (type == "number" || type == "integer") {
    if (type == "integer" ? !value.is_number_integer() : !value.is_number()) return at + ": type";
    const double number = value.get<double>();
    const bool fits = number >= schema.value("minimum", -1e300) &&
                      number <= schema.value("maximum", 1e300) &&
                      number > schema.value("exclusiveMinimum", -1e300) &&
                      number < schema.value("exclusiveMaximum", 1e300);
    return fits ? "" : at + ": out of bounds";
  }
  if (type == "string") return value.is_string() ? "" : at + ": type";
  if (type == "boolean") return value.is_boolean() ? "" : at + ": type";
  if (type == "array") {
    if (!value.is_array() || value.size() < schema.value("minItems", 0U) ||
        value.size() > schema.value("maxItems", 1000U)) {
      return at + ": type";
    }
    for (const json& item : value) {
      std::string inside = breach(schema["items"], item, at + "[]");
      if (!inside.empty()) return inside;
    }
    return {};
  }
  if (type != "object") return {};
  if (!value.is_object()) return at + ": type";
  for (const json& key : schema.value("required", json::array())) {
    if (!value.contains(key)) return at + ": no " + key.get<std::string>();
  }
  for (const auto& [key, inside] : value.items()) {
    if (!schema.contains("properties") || !schema["properties"].contains(key)) {
      if (schema.value("additionalProperties", true)) continue;
      return at + ": unknown " + key;
    }
    std::string below = breach(schema["properties"][key], inside, at + "." + key);
    if (!below.empty()) return below;
  }
  return {};
}

TEST(DeviceSchema, HoldsForEveryShippedFile) {
  for (const auto& file : device_files()) {
    const auto device = load_device(file);
    const json schema = json::parse(device_schema(device->kind()));
    EXPECT_EQ(breach(schema, json::parse(device->settings().as_read)), "") << file;
  }
}

// What a reader refuses for its own sake, the schema does too, and the other way round.
TEST(DeviceSchema, RefusesWhatTheReaderDoes) {
  const std::filesystem::path scratch =
      std::filesystem::path(testing::TempDir()) / ("schema_" + std::to_string(getpid()) + ".toml");
  const auto refused = [&](const std::string& text) {
    std::ofstream(scratch) << text;
    try {
      static_cast<void>(load_device(scratch));
    } catch (const InputError&) {
      return true;
    }
    return false;
  };
  for (const auto& file : device_files()) {
    std::ifstream input(file);
    std::stringstream content;
    content << input.rdbuf();
    const auto device = load_device(file);
    const json schema = json::parse(device_schema(device->kind()));
    if (!schema.contains("additionalProperties")) continue;  // of a kind with any keys
    const json good = json::parse(device->settings().as_read);
    EXPECT_FALSE(refused(content.str())) << file;
    EXPECT_TRUE(refused("colour = \"red\"\n" + content.str())) << file;
    json bad = good;
    bad["colour"] = "red";
    EXPECT_NE(breach(schema, bad), "") << file;

    EXPECT_TRUE(refused(content.str() + "\n[extra]\nwidth_mm = 1.0\n")) << file;
    bad = good;
    bad["extra"] = {{"width_mm", 1.0}};
    EXPECT_NE(breach(schema, bad), "") << file;

    std::string far = content.str();
    far.replace(far.find("approach_mm ="), 13, "approach_mm = -1.0 #");
    EXPECT_TRUE(refused(far)) << file;
    bad = good;
    bad["matching"]["approach_mm"] = -1.0;
    EXPECT_NE(breach(schema, bad), "") << file;

    bad = good;
    bad["mount"]["translation_mm"] = {1.0, 2.0};
    EXPECT_NE(breach(schema, bad), "") << file;
  }
}

TEST(DeviceSchema, NamesTheKindsForAnUnknownOne) {
  try {
    static_cast<void>(device_schema("pin_arrow"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("did you mean 'pin_array'"));
    for (const std::string& kind : device_kinds()) {
      EXPECT_THAT(error.what(), testing::HasSubstr(kind));
    }
  }
}

}  // namespace
}  // namespace softfinger
