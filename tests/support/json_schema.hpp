#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

namespace softfinger {

/// Where `value` breaks the schema; empty where it does not. As much of JSON Schema as those of
/// files have: type, properties, patternProperties, additionalProperties, required, enum, const,
/// bounds, pattern, items, anyOf.
inline std::string breach(const nlohmann::json& schema, const nlohmann::json& value,
                          const std::string& at = "") {
  using nlohmann::json;
  if (schema.contains("anyOf")) {
    std::string all;
    for (const json& choice : schema["anyOf"]) {
      const std::string inside = breach(choice, value, at);
      if (inside.empty()) return {};
      all += "(" + inside + ")";
    }
    return at + ": none of several " + all;
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
  if (type == "string") {
    if (!value.is_string()) return at + ": type";
    const bool fits = !schema.contains("pattern") ||
                      std::regex_search(value.get<std::string>(),
                                        std::regex(schema["pattern"].get<std::string>()));
    return fits ? "" : at + ": pattern";
  }
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
    // Of a string: to look for a value makes every file here compile comparisons of values.
    if (!value.contains(key.get<std::string>())) return at + ": no " + key.get<std::string>();
  }
  const json by_pattern = schema.value("patternProperties", json::object());
  for (const auto& [key, inside] : value.items()) {
    const json* rule = nullptr;
    if (schema.contains("properties") && schema["properties"].contains(key)) {
      rule = &schema["properties"][key];
    }
    for (const auto& [pattern, schema_of_it] : by_pattern.items()) {
      if (rule == nullptr && std::regex_search(key, std::regex(pattern))) rule = &schema_of_it;
    }
    if (rule == nullptr && schema.contains("additionalProperties")) {
      const json& others = schema["additionalProperties"];
      if (others.is_object()) rule = &others;
      if (others == false) return at + ": unknown " + key;
    }
    if (rule == nullptr) continue;
    std::string below = breach(*rule, inside, at + "." + key);
    if (!below.empty()) return below;
  }
  return {};
}

/// Where a schema leaves open what a table may hold; empty where it is strict all through.
inline std::string open_end(const nlohmann::json& schema, const std::string& at = "") {
  using nlohmann::json;
  for (const json& choice : schema.value("anyOf", json::array())) {
    if (std::string inside = open_end(choice, at); !inside.empty()) return inside;
  }
  const std::string type = schema.value("type", "");
  const bool says = schema.contains("anyOf") || schema.contains("const") || schema.contains("enum");
  if (type.empty() && !says) return at + ": any type";
  if (type == "array") {
    return schema.contains("items") ? open_end(schema["items"], at + "[]") : at + ": any items";
  }
  if (type != "object") return {};
  if (!schema.contains("additionalProperties")) return at + ": any keys";
  const json& others = schema["additionalProperties"];
  if (others != false && !others.is_object()) return at + ": any keys";
  if (others.is_object()) {
    if (std::string inside = open_end(others, at + ".*"); !inside.empty()) return inside;
  }
  for (const char* group : {"properties", "patternProperties"}) {
    if (!schema.contains(group)) continue;
    for (const auto& [key, of_key] : schema[group].items()) {
      if (std::string inside = open_end(of_key, at + "." + key); !inside.empty()) return inside;
    }
  }
  return {};
}

}  // namespace softfinger
