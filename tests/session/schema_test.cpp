// JSON Schemas of all files that people write: strict, and every shipped file holds.
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "../support/json_schema.hpp"
#include "../support/toml_json.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/device/kinds/device_kinds.hpp"
#include "softfinger/finger/finger_file.hpp"
#include "softfinger/person/person.hpp"
#include "softfinger/scene/scene_schema.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<fs::path> files(const char* kind) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(fs::path(source_folder()) / kind)) {
    if (entry.path().extension() == ".toml") found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  EXPECT_FALSE(found.empty()) << kind;
  return found;
}

TEST(Schemas, AreStrictAllThrough) {
  EXPECT_EQ(open_end(json::parse(scene_schema())), "");
  EXPECT_EQ(open_end(json::parse(finger_schema())), "");
  EXPECT_EQ(open_end(json::parse(person_schema())), "");
  for (const std::string& kind : device_kind_names()) {
    EXPECT_EQ(open_end(json::parse(device_schema(kind))), "") << kind;
  }
  // The look itself sees what is open.
  EXPECT_NE(open_end(json::parse(R"({"type": "object"})")), "");
  EXPECT_NE(open_end(json::parse(R"({"type": "object", "additionalProperties": false,
                                     "properties": {"a": {"type": "array"}}})")),
            "");
}

TEST(Schemas, HoldForEveryShippedFileAndNoUnknownKey) {
  const auto check = [](const fs::path& file, const json& schema, const toml::table& root) {
    json content = to_json(root);
    EXPECT_EQ(breach(schema, content), "") << file;
    content["colour"] = "red";
    EXPECT_NE(breach(schema, content), "") << file;
  };
  for (const fs::path& file : files("scenes")) {
    check(file, json::parse(scene_schema()), toml::parse_file(file.string()));
  }
  for (const fs::path& file : files("fingers")) {
    check(file, json::parse(finger_schema()), toml::parse_file(file.string()));
  }
  for (const fs::path& file : files("devices")) {
    const toml::table root = toml::parse_file(file.string());
    check(file, json::parse(device_schema(root["kind"].value_or(""))), root);
  }
}

TEST(Schemas, OfScenesKnowWhatMovesByForces) {
  const json schema = json::parse(scene_schema());
  const auto scene = [](const std::string& object) {
    return to_json(toml::parse("[[object]]\nshape = \"sphere\"\nradius_mm = 5\n" + object));
  };
  const std::string moves = "motion = \"dynamic\"\nmass_g = 1\n";
  EXPECT_EQ(breach(schema, scene("")), "");
  EXPECT_EQ(breach(schema, scene(moves)), "");
  EXPECT_EQ(breach(schema, scene(moves + "joint = {kind = \"ball\", parent = \"a\"}")), "");
  EXPECT_EQ(breach(schema, scene(moves + "joint = {kind = \"slider\", axis = [0, 0, 1]}")), "");
  EXPECT_NE(breach(schema, scene(moves + "joint = {kind = \"ball\", axis = [0, 0, 1]}")), "");
  EXPECT_NE(breach(schema, scene(moves + "joint = {kind = \"slider\"}")), "");
  EXPECT_NE(breach(schema, scene(moves + "waypoint = [{time_s = 0}]")), "");
  EXPECT_NE(breach(schema, scene("mass_g = 1")), "");
  EXPECT_NE(breach(schema, scene("motion = \"free\"")), "");
}

}  // namespace
}  // namespace softfinger
