#pragma once

#include <toml++/toml.h>

#include <nlohmann/json.hpp>
#include <string>

namespace softfinger {

/// The same values as JSON, for schemas to judge; null for what JSON has no word for.
inline nlohmann::json to_json(const toml::node& node) {
  using nlohmann::json;
  if (const toml::table* table = node.as_table()) {
    json object = json::object();
    for (const auto& [key, value] : *table) object[std::string(key.str())] = to_json(value);
    return object;
  }
  if (const toml::array* array = node.as_array()) {
    json list = json::array();
    for (const toml::node& value : *array) list.push_back(to_json(value));
    return list;
  }
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* integer = node.as_integer()) return integer->get();
  if (const auto* number = node.as_floating_point()) return number->get();
  if (const auto* truth = node.as_boolean()) return truth->get();
  return nullptr;
}

}  // namespace softfinger
