// JSON Schemas of all files that people write, against the readers that they are made from: every
// shipped file holds, and what is spoilt is refused by both.
#include <gtest/gtest.h>
#include <toml++/toml.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "../support/json_schema.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/engine/person.hpp"
#include "softfinger/finger/finger_file.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/scene/scene_schema.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json to_json(const toml::node& node) {
  std::ostringstream text;
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
  if (const auto* text_node = node.as_string()) return text_node->get();
  if (const auto* integer = node.as_integer()) return integer->get();
  if (const auto* number = node.as_floating_point()) return number->get();
  if (const auto* truth = node.as_boolean()) return truth->get();
  return nullptr;
}

/// Calls `use` with the table and key of every value, those in arrays of tables too.
void for_each_key(toml::table& table,
                  const std::function<void(toml::table& table, const std::string& key)>& use) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : table) keys.emplace_back(key.str());
  for (const std::string& key : keys) {
    if (toml::table* inner = table[key].as_table()) for_each_key(*inner, use);
    if (toml::array* list = table[key].as_array()) {
      for (toml::node& element : *list) {
        if (toml::table* inner = element.as_table()) for_each_key(*inner, use);
      }
    }
    use(table, key);
  }
}

/// A folder beside which everything that shipped files name is found.
class Schemas : public testing::Test {
 protected:
  Schemas() {
    folder_ = fs::path(testing::TempDir()) / ("schemas_" + std::to_string(getpid()));
    fs::create_directories(folder_ / "spoilt");
    const fs::path tree = SOFTFINGER_SOURCE_DIR;
    for (const char* kind : {"fingers", "devices", "objects", "scenes"}) {
      fs::create_directory_symlink(tree / kind, folder_ / kind);
    }
    for (const fs::path& mesh : files("fingers", ".msh")) {
      fs::create_symlink(mesh, folder_ / "spoilt" / mesh.filename());
    }
  }
  ~Schemas() override { fs::remove_all(folder_); }

  static std::vector<fs::path> files(const char* kind, const char* extension = ".toml") {
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(fs::path(SOFTFINGER_SOURCE_DIR) / kind)) {
      if (entry.path().extension() == extension) found.push_back(entry.path());
    }
    std::sort(found.begin(), found.end());
    EXPECT_FALSE(found.empty()) << kind;
    return found;
  }

  using Reader = std::function<void(const fs::path& file)>;
  bool is_refused(const Reader& read, const std::string& text) const {
    const fs::path file = folder_ / "spoilt" / "file.toml";
    std::ofstream(file, std::ios::trunc) << text;
    try {
      read(file);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      return true;
    }
    return false;
  }
  static std::string written(const toml::table& table) {
    std::ostringstream text;
    text << table;
    return text.str();
  }

  /// Spoils every key of a file in every way, one at a time.
  void spoil(const std::string& name, const json& schema, const Reader& read, toml::table root) {
    ASSERT_EQ(breach(schema, to_json(root)), "") << name;
    const auto check = [&](const std::string& what, bool must_be_refused) {
      const std::string text = written(root);
      const bool by_schema = !breach(schema, to_json(root)).empty();
      if (!must_be_refused && !by_schema) return;
      ++spoilt_;
      EXPECT_TRUE(by_schema) << name << ": " << what;
      EXPECT_TRUE(is_refused(read, text)) << name << ": " << what << "\n" << text;
    };
    const auto add_unknown = [&](toml::table& table, const std::string& where) {
      table.insert("colour", "red");
      check("unknown key in " + where, true);
      table.erase("colour");
    };
    add_unknown(root, "the file");
    for_each_key(root, [&](toml::table& table, const std::string& key) {
      if (toml::table* inner = table[key].as_table()) add_unknown(*inner, key);
      if (toml::array* list = table[key].as_array(); list && list->is_array_of_tables()) {
        add_unknown(*list->get(0)->as_table(), key);
      }
      // Another type, a number that may be out of range, another word, nothing.
      const toml::table before = table;
      const auto with = [&](const auto& value, const std::string& what, bool must_be_refused) {
        table.insert_or_assign(key, value);
        check(key + " " + what, must_be_refused);
        table = before;
      };
      if (table[key].is_number()) {
        with("a text", "as text", true);
        with(-1e7, "far below", false);
        with(1e9, "far above", false);
      } else {
        with(1.5, "as a number", true);
      }
      if (table[key].is_string()) with("a word that nobody knows #", "as another word", false);
      if (const toml::array* list = table[key].as_array(); list && !list->is_array_of_tables()) {
        toml::array longer = *list;
        longer.push_back(1.0);
        with(longer, "with one more", true);
        toml::array other = *list;
        other.replace(other.begin(), "a text");
        with(other, "with a text", true);
      }
      table.erase(key);
      check(key + " left out", false);
      table = before;
    });
  }

  fs::path folder_;
  int spoilt_ = 0;
};

TEST_F(Schemas, AreStrictAllThrough) {
  EXPECT_EQ(open_end(json::parse(scene_schema())), "");
  EXPECT_EQ(open_end(json::parse(finger_schema())), "");
  EXPECT_EQ(open_end(json::parse(person_schema())), "");
  for (const std::string& kind : device_kinds()) {
    EXPECT_EQ(open_end(json::parse(device_schema(kind))), "") << kind;
  }
  // The look itself sees what is open.
  EXPECT_NE(open_end(json::parse(R"({"type": "object"})")), "");
  EXPECT_NE(open_end(json::parse(R"({"type": "object", "additionalProperties": false,
                                     "properties": {"a": {"type": "array"}}})")),
            "");
}

TEST_F(Schemas, SceneFilesHoldAndAreRefusedByBothWhenSpoilt) {
  const json schema = json::parse(scene_schema());
  for (const fs::path& file : files("scenes")) {
    toml::table root = toml::parse_file(file.string());
    EXPECT_EQ(breach(schema, to_json(root)), "") << file;
  }
  // Every key and shape; what is not refused would load meshes.
  const std::string text = R"toml(
description = "all there is"
[rates]
simulation_Hz = 1000.0
[[finger]]
name = "index"
model = "../fingers/index.toml"
device = "../devices/membrane.toml"
tracker = "script"
[[finger.waypoint]]
time_s = 0.0
position_mm = [0.0, 0.0, 40.0]
rotation_vector_deg = [0.0, 0.0, 0.0]
[[object]]
name = "floor"
shape = "plane"
position_mm = [0.0, 0.0, 0.0]
rotation_vector_deg = [0.0, 0.0, 0.0]
friction_coefficient = 0.5
[[object.waypoint]]
time_s = 0.0
position_mm = [0.0, 0.0, 0.0]
rotation_vector_deg = [0.0, 0.0, 0.0]
[[object]]
shape = "sphere"
radius_mm = 20.0
[[object]]
shape = "box"
size_mm = [10.0, 10.0, 10.0]
edge_radius_mm = 1.0
[[object]]
shape = "cylinder"
radius_mm = 20.0
length_mm = 20.0
edge_radius_mm = 1.0
[[object]]
shape = "mesh"
file = "../objects/needle.stl"
unit = "mm"
edge_rounding_mm = 0.25
)toml";
  spoil(
      "scene", schema, [](const fs::path& file) { (void)load_scene(file); }, toml::parse(text));
  EXPECT_GT(spoilt_, 100);
}

TEST_F(Schemas, FingerFilesHoldAndAreRefusedByBothWhenSpoilt) {
  const json schema = json::parse(finger_schema());
  for (const fs::path& file : files("fingers")) {
    toml::table root = toml::parse_file(file.string());
    EXPECT_EQ(breach(schema, to_json(root)), "") << file;
  }
  const Reader read = [](const fs::path& file) { (void)FingerModel::load(file); };
  for (const char* name : {"index-viscoelastic.toml", "thumb.toml"}) {
    spoil(name, schema, read,
          toml::parse_file((fs::path(SOFTFINGER_SOURCE_DIR) / "fingers" / name).string()));
  }
  EXPECT_GT(spoilt_, 100);
}

TEST_F(Schemas, PersonFilesHoldAndAreRefusedByBothWhenSpoilt) {
  const std::string text = R"toml(
[index.size]
length_mm = 26.0
breadth_mm = 17.5
depth_mm = 14.0
[index.registration]
translation_mm = [-3.0, 0.5, -14.0]
rotation_vector_deg = [0.0, 12.0, 0.0]
[thumb.size]
breadth_mm = 21
)toml";
  spoil(
      "person", json::parse(person_schema()), [](const fs::path& file) { (void)load_person(file); },
      toml::parse(text));
  EXPECT_GT(spoilt_, 25);
}

TEST_F(Schemas, DeviceFilesHoldAndAreRefusedByBothWhenSpoilt) {
  const Reader read = [](const fs::path& file) { (void)load_device(file); };
  for (const fs::path& file : files("devices")) {
    toml::table root = toml::parse_file(file.string());
    const json schema = json::parse(device_schema(root["kind"].value_or("")));
    // Those of servos that differ in one joint only from the others cost most and say least.
    if (toml::array* servos = root["transport"]["servo"].as_array()) {
      EXPECT_EQ(breach(schema, to_json(root)), "") << file;
      if (servos->size() > 8) root.erase("transport");
    }
    spoil(file.filename(), schema, read, root);
  }
  EXPECT_GT(spoilt_, 500);
}

}  // namespace
}  // namespace softfinger
