#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;

TEST(SceneCheck, SaysWhatTheShippedScenesHold) {
  const Workplace place;
  for (const char* name : {"plane", "edge", "sphere"}) {
    const std::string scene = place.path(std::string("scenes/") + name + ".toml");
    const ProgramRun text = run_program({"scene", "check", scene});
    EXPECT_EQ(text.status, 0) << text.errors;
    EXPECT_THAT(text.output, HasSubstr("finger index"));
    EXPECT_THAT(text.output, HasSubstr("platform_3rrs"));
    const ProgramRun run = run_program({"scene", "check", scene, "--json"});
    EXPECT_EQ(run.status, 0);
    EXPECT_EQ(run.errors, "");
    const auto answer = nlohmann::json::parse(run.output);
    EXPECT_GE(answer.at("duration_s").get<double>(), 8.0);
    EXPECT_EQ(answer.at("fingers").size(), 1u);
    EXPECT_EQ(answer.at("objects").size(), 1u);
    EXPECT_GT(answer.at("fingers")[0].at("samples").get<int>(), 100);
  }
}

TEST(SceneCheck, OpensThePoseFileOfACsvTracker) {
  const Workplace place;
  place.replace_line("scenes/plane.toml", "tracker", "tracker = \"csv:poses.csv\"");
  const std::string scene = place.path("scenes/plane.toml");
  EXPECT_EQ(run_program({"scene", "check", scene}).status, 2);
  place.write("scenes/poses.csv",
              "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,0,0,40,1,0,0,0\n0.1,0,0,39,1,0,0,0\n");
  const ProgramRun run = run_program({"scene", "check", scene, "--json"});
  EXPECT_EQ(run.status, 0) << run.errors;
  EXPECT_DOUBLE_EQ(nlohmann::json::parse(run.output).at("duration_s").get<double>(), 0.1);
  place.write("scenes/poses.csv", "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,0,0,40,1,0,0,x\n");
  const ProgramRun bad = run_program({"scene", "check", scene});
  EXPECT_EQ(bad.status, 2);
  EXPECT_THAT(bad.errors, HasSubstr("poses.csv:2: qz"));
}

}  // namespace
}  // namespace softfinger
