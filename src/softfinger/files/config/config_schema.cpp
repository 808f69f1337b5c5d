#include "softfinger/files/config/config_schema.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "softfinger/base/unit_words.hpp"
#include "softfinger/files/config/config_node.hpp"

namespace softfinger {
namespace {

/// One of several schemas, each once.
Json any_of(const std::vector<Json>& schemas) {
  Json distinct = Json::array();
  for (const Json& schema : schemas) {
    if (std::find(distinct.begin(), distinct.end(), schema) == distinct.end()) {
      distinct.push_back(schema);
    }
  }
  return distinct.size() == 1 ? distinct[0] : Json{{"anyOf", distinct}};
}

}  // namespace

Json number_schema(std::string_view key, const Range& range) {
  Json schema{{"type", "number"}};
  if (const auto unit = unit_words(key); !unit.empty()) schema["description"] = unit;
  if (std::isfinite(range.min)) schema[range.open_min ? "exclusiveMinimum" : "minimum"] = range.min;
  if (std::isfinite(range.max)) schema[range.open_max ? "exclusiveMaximum" : "maximum"] = range.max;
  return schema;
}

Json integer_schema(int min, int max) {
  return {{"type", "integer"}, {"minimum", min}, {"maximum", max}};
}

Json numbers_schema(std::string_view key, int size, const Range& range) {
  return {{"type", "array"},
          {"items", number_schema(key, range)},
          {"minItems", size},
          {"maxItems", size}};
}

Json ConfigTable::Node::schema_of(const Rule& rule) {
  const Answer& value = answer(rule.key);
  if (const Child* table_node = std::get_if<Child>(&value)) return (*table_node)->schema();
  Json schema = rule.schema;
  if (const auto* list = std::get_if<std::vector<Child>>(&value); list && !list->empty()) {
    std::vector<Json> kinds;
    for (const Child& element : *list) kinds.push_back(element->schema());
    schema["items"] = any_of(kinds);
  }
  return schema;
}

Json ConfigTable::Node::schema() {
  Json object{{"type", "object"},
              {"properties", Json::object()},
              {"required", Json::array()},
              {"additionalProperties", false}};
  std::map<std::string, std::vector<Json>> of_any_name;  // by the pattern of the name
  for (const Rule& rule : rules) {
    if (rule.any_name) {
      of_any_name[rule.pattern].push_back(schema_of(rule));
      continue;
    }
    if (rule.required) object["required"].push_back(rule.key);
    object["properties"][rule.key] = schema_of(rule);
  }
  if (object["required"].empty()) object.erase("required");
  for (const auto& [pattern, schemas] : of_any_name) {
    if (pattern.empty()) {
      object["additionalProperties"] = any_of(schemas);
    } else {
      object["patternProperties"][pattern] = any_of(schemas);
    }
  }
  return object;
}

}  // namespace softfinger
