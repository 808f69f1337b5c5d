// Files of scenes, fingers, devices and persons, spoilt key by key: what the schema refuses the
// reader refuses too, in one line, and nothing but a refusal comes of any of them.
#include <gtest/gtest.h>
#include <toml++/toml.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "../support/folders.hpp"
#include "../support/json_schema.hpp"
#include "../support/toml_json.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_file.hpp"
#include "softfinger/person/person.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/scene/scene_schema.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Reader = std::function<void(const fs::path& file)>;
using Change = std::function<void(toml::table& table, const std::string& key)>;

const fs::path kTree = source_folder();

/// One way to spoil one key of a file.
struct Spoiling {
  std::string what;
  std::vector<std::string> tables;  // to the key's own: keys, and places in arrays
  std::string key;
  bool must_be_refused;
  Change change;
};

template <class T>
void set(toml::table& table, const std::string& key, const T& value) {
  table.insert_or_assign(key, value);
}

void spoilings_of(const toml::table& table, const std::vector<std::string>& way,
                  std::vector<Spoiling>& all) {
  const auto add = [&](const std::string& key, const std::string& what, bool must_be_refused,
                       const Change& change) {
    std::string name;
    for (const std::string& step : way) name += step + ".";
    all.push_back({name + key + " " + what, way, key, must_be_refused, change});
  };
  const auto to = [&](const std::string& key, const auto& value, const std::string& what,
                      bool must_be_refused = true) {
    add(key, what, must_be_refused,
        [value](toml::table& at, const std::string& name) { set(at, name, value); });
  };
  to("colour", "red", "that nobody knows");
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const auto& [toml_key, value] : table) {
    const std::string key(toml_key.str());
    to(key, toml::array{toml::array{1.0}}, "as an array of arrays");
    to(key, toml::date{2026, 1, 1}, "as a date");
    add(key, "left out", false, [](toml::table& at, const std::string& name) { at.erase(name); });
    if (value.is_number()) {
      to(key, "a text", "as text");
      to(key, true, "as truth");
      to(key, toml::array{1.0}, "as an array");
      to(key, std::numeric_limits<double>::quiet_NaN(), "NaN");
      to(key, kInfinite, "infinite");
      to(key, -kInfinite, "infinite below");
      to(key, -1e7, "far below", false);
      to(key, 1e9, "far above", false);
      to(key, 1e200, "huge", false);
      to(key, std::numeric_limits<std::int64_t>::max(), "the greatest integer", false);
      to(key, std::numeric_limits<std::int64_t>::min(), "the least integer", false);
    } else {
      to(key, 1.5, "as a number");
      to(key, std::numeric_limits<std::int64_t>::max(), "as a huge number");
    }
    if (value.is_string()) to(key, "a word that nobody knows #", "as another word", false);
    if (const toml::table* inner = value.as_table()) {
      std::vector<std::string> below = way;
      below.push_back(key);
      spoilings_of(*inner, below, all);
    }
    const toml::array* list = value.as_array();
    if (list == nullptr) continue;
    if (!list->is_array_of_tables()) {
      toml::array longer = *list;
      longer.push_back(1.0);
      to(key, longer, "with one more", false);
      to(key, toml::array{}, "empty", false);
      for (const auto& [name, number] : {std::pair{"with NaN", std::nan("")},
                                         {"with infinity", kInfinite},
                                         {"with a huge number", 1e200}}) {
        toml::array other = *list;
        if (other.empty() || !other[0].is_number()) break;
        other.replace(other.begin(), number);
        to(key, other, name, std::string(name) != "with a huge number");
      }
      continue;
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
      std::vector<std::string> below = way;
      below.push_back(key);
      below.push_back(std::to_string(i));
      spoilings_of(*(*list)[i].as_table(), below, all);
    }
  }
}

/// A spoilt copy: nothing points into a table that has changed.
toml::table spoilt(toml::table root, const Spoiling& spoiling) {
  toml::node* node = &root;
  for (const std::string& step : spoiling.tables) {
    toml::array* list = node->as_array();
    node = list != nullptr ? list->get(std::stoul(step)) : node->as_table()->get(step);
  }
  spoiling.change(*node->as_table(), spoiling.key);
  return root;
}

/// A folder beside which everything that shipped files name is found.
class SpoiltFiles : public testing::Test {
 protected:
  SpoiltFiles() {
    folder_ = fs::path(testing::TempDir()) / ("spoilt_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    for (const auto& entry : fs::directory_iterator(kTree / "fingers")) {
      if (entry.path().extension() == ".msh") {
        fs::create_symlink(entry.path(), folder_ / entry.path().filename());
      }
    }
    std::ofstream(folder_ / "solid.obj") << "v 0 0 0\nv 20 0 0\nv 0 20 0\nv 0 0 20\n"
                                            "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  }
  ~SpoiltFiles() override { fs::remove_all(folder_); }

  /// Reads the file spoilt in `usual` drawn ways, under the long check (SOFTFINGER_SPOILT=all) in
  /// all.
  void spoil(const std::string& name, const json& schema, const Reader& read,
             const toml::table& root, std::size_t usual) {
    ASSERT_EQ(breach(schema, to_json(root)), "") << name;
    std::vector<Spoiling> ways;
    spoilings_of(root, {}, ways);
    const char* size = std::getenv("SOFTFINGER_SPOILT");  // NOLINT(concurrency-mt-unsafe)
    if (size == nullptr || std::string(size) != "all") {
      std::mt19937 draw(20261122);  // NOLINT(cert-msc51-cpp,bugprone-random-generator-seed)
      std::ranges::shuffle(ways, draw);
      ways.resize(std::min(ways.size(), usual));
    }
    int refused = 0;
    int tried = 0;
    for (const Spoiling& way : ways) {
      const toml::table file = spoilt(root, way);
      const bool by_schema = !breach(schema, to_json(file)).empty();
      EXPECT_TRUE(by_schema || !way.must_be_refused) << name << ": " << way.what;
      if (!by_schema && !reads_what_holds_) continue;
      ++tried;
      const bool by_reader = is_refused(read, file, name + ": " + way.what);
      EXPECT_TRUE(by_reader || !by_schema) << name << ": " << way.what;
      refused += by_reader ? 1 : 0;
    }
    EXPECT_GT(2 * refused, tried) << name;
    EXPECT_GE(tried, std::min<int>(static_cast<int>(usual) / 3, 20)) << name;
  }

  fs::path folder_;
  bool reads_what_holds_ = true;  // mechanisms take long where nothing is wrong

 private:
  [[nodiscard]] bool is_refused(const Reader& read, const toml::table& root,
                                const std::string& what) const {
    const fs::path file = folder_ / "file.toml";
    {
      std::ofstream stream(file, std::ios::trunc);
      stream << root;
    }
    try {
      read(file);
      return false;
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << what << ": " << message;
      EXPECT_NE(message.find(folder_.string()), std::string::npos) << what << ": " << message;
      return true;
    } catch (const std::exception& error) {
      ADD_FAILURE() << what << ": not a refusal but " << error.what();
      return true;
    }
  }
};

TEST_F(SpoiltFiles, ScenesAreRefusedAsTheirSchemaSays) {
  const std::string text = R"toml(
description = "all there is"
[rates]
simulation_Hz = 1000.0
[[finger]]
name = "index"
model = "index.toml"
device = "membrane.toml"
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
file = "solid.obj"
unit = "mm"
edge_rounding_mm = 4.0
)toml";
  spoil(
      "scene", json::parse(scene_schema()), [](const fs::path& file) { (void)load_scene(file); },
      toml::parse(text), 120);
}

TEST_F(SpoiltFiles, FingersAreRefusedAsTheirSchemaSays) {
  const json schema = json::parse(finger_schema());
  for (const char* name : {"index-viscoelastic.toml", "thumb.toml"}) {
    spoil(
        name, schema, [](const fs::path& file) { (void)FingerModel::load(file); },
        toml::parse_file((kTree / "fingers" / name).string()), 40);
  }
}

TEST_F(SpoiltFiles, DevicesAreRefusedAsTheirSchemaSays) {
  int files = 0;
  for (const auto& entry : fs::directory_iterator(kTree / "devices")) {
    if (entry.path().extension() != ".toml") continue;
    const toml::table root = toml::parse_file(entry.path().string());
    const std::string kind = root["kind"].value_or("");
    reads_what_holds_ = kind != "mechanism";
    spoil(
        entry.path().filename().string(), json::parse(device_schema(kind)),
        [](const fs::path& file) { (void)load_device(file); }, root, 30);
    ++files;
  }
  EXPECT_GE(files, 15);
}

TEST_F(SpoiltFiles, PersonsAreRefusedAsTheirSchemaSays) {
  const std::string text = R"toml(
[index.size]
length_mm = 25.0
breadth_mm = 16.0
depth_mm = 13.5
[index.registration]
translation_mm = [1.0, 2.0, 3.0]
rotation_vector_deg = [0.0, 10.0, 0.0]
)toml";
  spoil(
      "person", json::parse(person_schema()), [](const fs::path& file) { (void)load_person(file); },
      toml::parse(text), 60);
}

}  // namespace
}  // namespace softfinger
