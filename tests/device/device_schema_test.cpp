#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../support/json_schema.hpp"
#include "kinds.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/device/kinds/device_kinds.hpp"

namespace softfinger {
namespace {

using nlohmann::json;

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
    if (const auto at = far.find("\napproach_mm ="); at != std::string::npos) {
      far.replace(at + 1, 13, "approach_mm = -1.0 #");
    } else if (far.find("[matching]") == std::string::npos) {
      far += "\n[matching]\napproach_mm = -1.0\n";
    } else {
      far.replace(far.find("[matching]"), 10, "[matching]\napproach_mm = -1.0");
    }
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
    for (const std::string& kind : device_kind_names()) {
      EXPECT_THAT(error.what(), testing::HasSubstr(kind));
    }
  }
}

}  // namespace
}  // namespace softfinger
