// Scenes of objects that move, without a finger: checked, run, replayed and exported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A bob on a thread without weight, level at the start, and a ball that falls.
constexpr const char* kPendulum = R"([[object]]
name = "bob"
shape = "sphere"
radius_mm = 1
position_mm = [100, 0, 0]
motion = "dynamic"
mass_g = 30
[object.joint]
kind = "hinge"
axis = [0, 1, 0]
point_mm = [-100, 0, 0]
[[object]]
name = "ball"
shape = "sphere"
radius_mm = 5
position_mm = [0, 50, 0]
motion = "dynamic"
mass_g = 3
)";

class SceneWithoutFinger : public testing::Test {
 protected:
  SceneWithoutFinger() { place.write("scenes/pendulum.toml", kPendulum); }
  [[nodiscard]] std::vector<std::string> run(const std::vector<std::string>& flags) const {
    std::vector<std::string> all{"run", scene, "--headless", "--as-fast-as-possible"};
    all.insert(all.end(), flags.begin(), flags.end());
    return all;
  }
  const Workplace place;
  const std::string scene = place.path("scenes/pendulum.toml");
};

TEST_F(SceneWithoutFinger, IsCheckedAndSaysWhatMovesHow) {
  const ProgramRun text = run_program({"scene", "check", scene});
  EXPECT_EQ(text.status, 0) << text.errors;
  EXPECT_THAT(text.output, HasSubstr("30 g, hinge on the world"));
  EXPECT_THAT(text.output, HasSubstr("3 g, free"));
  const json answer = json::parse(run_program({"scene", "check", scene, "--json"}).output);
  EXPECT_EQ(answer.at("objects")[0].at("joint").at("kind"), "hinge");
  EXPECT_TRUE(answer.at("objects")[1].at("joint").is_null());
  EXPECT_EQ(answer.at("objects")[1].at("mass_g"), 3.0);
  EXPECT_TRUE(answer.at("objects")[1].at("moves").get<bool>());
}

TEST_F(SceneWithoutFinger, RunsForATimeAndReplaysToTheBit) {
  const std::string file = place.path("run.sqlite");
  const ProgramRun done = run_program(run({"--duration-s", "0.1", "--json", "--record", file}));
  ASSERT_EQ(done.status, 0) << done.errors;
  const json objects = json::parse(done.output).at("objects");
  EXPECT_NEAR(objects.at("ball").at("position_mm")[2].get<double>(), -4905.0 * 0.01, 0.01);
  EXPECT_TRUE(objects.at("ball").at("joint").is_null());
  // It has hardly turned from level: as if it fell, less the inertia of its own turn.
  const double angle = objects.at("bob").at("joint").get<double>();
  EXPECT_NEAR(angle, 0.5 * 98.1 * 0.01 * 57.29577951308232, 0.6);
  EXPECT_EQ(run_program({"replay", file}).status, 0);
  const std::string tables = place.path("csv");
  ASSERT_EQ(run_program({"export", file, "--to", tables}).status, 0);
  const std::string csv = place.read("csv/objects.csv");
  EXPECT_THAT(csv, HasSubstr("\n0,bob,100,0,0,1,"));
  EXPECT_THAT(csv, HasSubstr("\n0.1,ball,"));
}

TEST_F(SceneWithoutFinger, IsToldWhatItNeeds) {
  expect_refused(run_program(run({})), {"pendulum.toml", "--duration-s"});
  expect_refused(run_program(run({"--duration-s", "1", "--tracker", "page"})),
                 {"--tracker page", "no finger"});
  expect_refused(run_program(run({"--duration-s", "1", "--tracker", "webxr"})),
                 {"--tracker webxr", "no finger"});
  expect_refused(run_program(run({"--duration-s", "1", "--device", "thimble-3rrs"})),
                 {"--device", "no finger"});
  expect_refused(run_program({"evaluate", scene}), {"pendulum.toml", "no finger"});
}

}  // namespace
}  // namespace softfinger
