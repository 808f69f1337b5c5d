#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using nlohmann::json;

json answer_of(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const ProgramRun run = run_program(arguments);
  EXPECT_EQ(run.status, 0) << arguments[0] << " " << arguments[1] << ": " << run.errors;
  return json::parse(run.output, nullptr, false);
}

std::vector<std::string> shipped_devices() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() + "/devices")) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  return files;
}

TEST(DeviceCommand, AnswersForEveryShippedDevice) {
  for (const std::string& file : shipped_devices()) {
    const json shown = answer_of({"device", "show", file});
    EXPECT_TRUE(shown.contains("mount")) << file;
    const json solved = answer_of({"device", "solve", file});
    EXPECT_EQ(solved.at("reachable"), true) << file;
    const bool linear = solved.contains("joints_mm");
    EXPECT_EQ(solved.at("joints_deg").is_null(), linear) << file;
    std::string joints;
    for (const json& joint : solved.at(linear ? "joints_mm" : "joints_deg")) {
      joints += (joints.empty() ? "" : ",") + joint.dump();
    }
    const json posed =
        answer_of({"device", "pose", file, linear ? "--joints-mm" : "--joints-deg", joints});
    for (const auto& [name, value] : solved.at("configuration").items()) {
      EXPECT_NEAR(posed.at("configuration").at(name).get<double>(), value.get<double>(), 1e-9);
    }
    EXPECT_FALSE(answer_of({"device", "workspace", file}).empty()) << file;
    // Of mechanisms there are two, with and without an approach.
    EXPECT_NE(answer_of({"device", "schema", file})
                  .dump()
                  .find("\"kind\":{\"const\":" + shown.at("kind").dump() + "}"),
              std::string::npos)
        << file;
  }
}

TEST(DeviceCommand, SchemaOfAllKinds) {
  const json schema = answer_of({"device", "schema"});
  const json& kinds = schema.at("properties").at("kind").at("enum");
  EXPECT_EQ(schema.at("anyOf").size(), kinds.size());
  EXPECT_NE(std::find(kinds.begin(), kinds.end(), "pin_array"), kinds.end());
}

// A device of every kind in the loop, recorded, replayed with the same bits and exported.
TEST(DeviceCommand, EveryShippedDeviceRunsInTheLoop) {
  const Workplace place;
  for (const std::string& file : shipped_devices()) {
    const std::string name = std::filesystem::path(file).stem();
    const std::string recording = place.path(name + ".sfr");
    const json run =
        answer_of({"run", place.path("scenes/sphere.toml"), "--headless", "--duration-s", "1.2",
                   "--as-fast-as-possible", "--device", file, "--record", recording});
    EXPECT_EQ(run.at("steps"), 1200) << file;
    EXPECT_EQ(answer_of({"replay", recording}).at("agree"), true) << file;
    ASSERT_EQ(run_program({"export", recording, "--to", place.path(name)}).status, 0);
    std::ifstream joints(place.path(name + "/joints.csv"));
    std::string header;
    std::getline(joints, header);
    const bool linear = answer_of({"device", "solve", file}).contains("joints_mm");
    EXPECT_NE(header.find(linear ? "joint_1_mm" : "joint_1_deg"), std::string::npos) << header;
  }
}

}  // namespace
}  // namespace softfinger
