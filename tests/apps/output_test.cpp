// What a command prints or writes arrives, or it says so: one line, status 1. Over all commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "help_text.hpp"
#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;
using Words = std::vector<std::string>;

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

void expect_one_line(const std::string& errors) {
  EXPECT_EQ(std::ranges::count(errors, '\n'), 1) << errors;
  EXPECT_TRUE(errors.starts_with("softfinger: ")) << errors;
}

/// A workplace with something to work on for each command.
class Commands : public testing::Test {
 protected:
  Commands() {
    place.write("poses.csv",
                "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,0,0,40,1,0,0,0\n0.1,0,0,40,1,0,0,0\n");
    place.write("points.json", R"({"points_mm": [[0, 0, -7], [1, 0, -7], [0, 1, -7]],
                                   "in_contact": [true, true, false]})");
    const ProgramRun press =
        run_program({"press", finger, "--to-mm", "0.5", "--steps", "6", "--json"});
    std::string curve = "indentation_mm,force_N\n";
    for (const nlohmann::json& row : nlohmann::json::parse(press.output)) {
      curve += row["indentation_mm"].dump() + "," + row["normal_force_N"].dump() + "\n";
    }
    place.write("curve.csv", curve);
    const ProgramRun run = run_program(Words{"run", scene, "--headless", "--as-fast-as-possible",
                                             "--duration-s", "0.1", "--record", recording});
    EXPECT_EQ(run.status, 0) << run.errors;
    EXPECT_EQ(run.errors, "");
    place.write("study.toml",
                "device = \"thimble-3rrs\"\n[vary]\ndevice.geometry.disk_radius_mm = "
                "{ values = [8] }\n[objectives]\nradius = { formula = "
                "\"device.geometry.disk_radius_mm\" }\n[design]\nkind = \"grid\"\n");
    EXPECT_EQ(run_program({"study", place.path("study.toml"), "--out", studied}).status, 0);
  }

  Workplace place;
  const std::string scene = place.path("scenes/sphere.toml");
  const std::string finger = place.path("fingers/index.toml");
  const std::string device = place.path("devices/thimble-3rrs.toml");
  const std::string recording = place.path("run.sqlite");
  const std::string studied = place.path("studied");
  const Words quick_run{"run",          scene, "--headless", "--as-fast-as-possible",
                        "--duration-s", "0.05"};
  const Words fit{"finger",
                  "fit",
                  finger,
                  "--data",
                  place.path("curve.csv"),
                  "--parameters",
                  "youngs_modulus_kPa"};
  const Words calibrate{"device",         "calibrate", device,    "--at",
                        "31.6,31.6,31.6", "--moved",   "10,10,10"};
};

TEST_F(Commands, OutputThatIsLostIsAFailure) {
  const Words by_json{"--json"};
  // Each command with what it needs, and the ways it prints. None is left out.
  const std::map<Words, std::vector<Words>> ways{
      {{"run"}, {quick_run, quick_run + by_json}},
      {{"press"},
       {{"press", finger, "--to-mm", "0.2", "--steps", "1"},
        {"press", finger, "--to-mm", "0.2", "--steps", "1", "--json"},
        {"press", finger, "--to-mm", "0.2", "--steps", "1", "--csv"}}},
      {{"match"},
       {{"match", device, "--points", place.path("points.json")},
        {"match", device, "--points", place.path("points.json"), "--json"}}},
      {{"evaluate"},
       {{"evaluate", scene, "--duration-s", "0.05"},
        {"evaluate", scene, "--duration-s", "0.05", "--json"}}},
      {{"device", "show"}, {{"device", "show", device}, {"device", "show", device, "--json"}}},
      {{"device", "solve"}, {{"device", "solve", device}, {"device", "solve", device, "--json"}}},
      {{"device", "pose"},
       {{"device", "pose", device, "--joints-deg", "20,20,20"},
        {"device", "pose", device, "--joints-deg", "20,20,20", "--json"}}},
      {{"device", "workspace"},
       {{"device", "workspace", device}, {"device", "workspace", device, "--json"}}},
      {{"device", "schema"}, {{"device", "schema"}, {"device", "schema", "membrane"}}},
      {{"device", "calibrate"}, {calibrate + Words{"--out", place.path("servos.toml")}}},
      {{"device", "fit"},
       {{"device", "fit", device, "--sensor", "emulator", "--finger", finger, "--person",
         place.path("fit.toml")}}},
      {{"finger", "show"}, {{"finger", "show", finger}, {"finger", "show", finger, "--json"}}},
      {{"finger", "schema"}, {{"finger", "schema"}, {"finger", "schema", "--person"}}},
      {{"scene", "schema"}, {{"scene", "schema"}}},
      {{"finger", "fit"}, {fit + Words{"--out", place.path("fitted.toml")}}},
      {{"finger", "register"},
       {{"finger", "register", "--person", place.path("anna.toml"), "--length-mm", "25"}}},
      {{"scene", "check"}, {{"scene", "check", scene}, {"scene", "check", scene, "--json"}}},
      {{"replay"}, {{"replay", recording}, {"replay", recording, "--json"}}},
      {{"export"}, {}},  // prints nothing
      {{"study", "export"}, {{"study", "export", studied, "--to", place.path("study.csv")}}},
      {{"study", "plot"}, {{"study", "plot", studied, "--to", place.path("plots")}}},
      {{"condition"}, {{"condition", recording, "--filter"}}},
      {{"emulate", "natnet"}, {}},  // below: until Ctrl-C
      {{"emulate", "udp"}, {{"emulate", "udp", place.path("poses.csv"), "--port", "9"}}},
      {{"emulate", "osc"}, {{"emulate", "osc", place.path("poses.csv"), "--port", "9"}}},
  };
  for (const Words& command : leaf_commands()) {
    EXPECT_TRUE(ways.contains(command)) << testing::PrintToString(command);
  }
  std::vector<Words> all{{"--version"}, {"--help"}, {"help"}, {"help", "run"}, {"run", "--help"}};
  for (const auto& [command, of_command] : ways) {
    all.insert(all.end(), of_command.begin(), of_command.end());
  }
  for (const Words& words : all) {
    SCOPED_TRACE(testing::PrintToString(words));
    const ProgramRun run = run_in_shell(R"(exec "$@" >/dev/full)", words);
    EXPECT_EQ(run.status, 1) << run.errors;
    EXPECT_THAT(run.errors, HasSubstr("softfinger: the output cannot be written"));
    expect_one_line(run.errors.substr(run.errors.find("softfinger: ")));
  }
}

TEST_F(Commands, OutputThatIsLostWhileItServes) {
  const std::string served = place.path("served.db");
  for (const Words& words : {Words{"emulate", "natnet", place.path("poses.csv"), "--port", "0"},
                             Words{"run", scene, "--port", "0", "--no-twin", "--record", served}}) {
    RunningProgram program(words, R"(echo ready >&2; exec "$@" >/dev/full)");
    ASSERT_TRUE(program.says("ready", 10.0));
    const bool records = words.front() == "run";
    for (int i = 0; i < 2000 && records && !std::filesystem::exists(served); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_FALSE(program.says("no such text", 1.5));
    const ProgramRun run = program.stop(SIGINT);
    EXPECT_EQ(run.status, 1) << run.errors;
    EXPECT_THAT(run.errors, HasSubstr("the output cannot be written"));
  }
}

TEST_F(Commands, AClosedOutputIsNoFileOfTheRun) {
  const std::string file = place.path("closed.sqlite");
  const ProgramRun run = run_in_shell(R"(exec "$@" >&- <&-)", quick_run + Words{"--record", file});
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.errors, HasSubstr("the output cannot be written"));
  EXPECT_EQ(run_program({"replay", file}).status, 0);
}

// A folder that is a file, and a quota of nothing: each who writes files says which it could not.
TEST_F(Commands, FilesThatCannotBeWrittenAreNamed) {
  place.write("no-folder", "a file");
  const std::string nowhere = place.path("no-folder/new");
  const auto writing = [&](const std::string& file) {
    return std::vector<Words>{
        quick_run + Words{"--record", file},
        {"press", finger, "--to-mm", "0.2", "--steps", "1", "--export", file},
        fit + Words{"--out", file},
        calibrate + Words{"--out", file},
        {"finger", "register", "--person", file, "--length-mm", "25"},
        {"export", recording, "--to", file},
        {"export", recording, "--to", file + ".h5"},
        {"export", recording, "--to", file + ".mcap"},
    };
  };
  for (const Words& words : writing(nowhere)) {
    SCOPED_TRACE(testing::PrintToString(words));
    const ProgramRun run = run_program(words);
    EXPECT_THAT(run.status, testing::AnyOf(1, 2));
    EXPECT_EQ(run.output, "");
    expect_one_line(run.errors);
    EXPECT_THAT(run.errors, HasSubstr(nowhere));
  }
  const std::string quota =
      R"(set -o pipefail; (ulimit -f 0; exec "$@" >/dev/null) 2>&1 | cat >&2)";
  for (const Words& words : writing(place.path("new"))) {
    SCOPED_TRACE(testing::PrintToString(words));
    const ProgramRun run = run_in_shell(quota, words);
    EXPECT_EQ(run.status, 1) << run.errors;
    expect_one_line(run.errors);
    EXPECT_THAT(run.errors, HasSubstr(place.path("new")));
    std::filesystem::remove_all(place.path("new"));
  }
}

TEST_F(Commands, AQuotaThatIsFullEndsTheRecordingAndNotTheRun) {
  const std::string file = place.path("quota.sqlite");
  const std::string quota =
      R"(set -o pipefail; (ulimit -f 600; exec "$@" >/dev/null) 2>&1 | cat >&2)";
  const ProgramRun run =
      run_in_shell(quota, {"run", scene, "--headless", "--duration-s", "4", "--as-fast-as-possible",
                           "--record-state", "--record", file});
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.errors, HasSubstr("the run goes on unrecorded"));
  EXPECT_THAT(run.errors, HasSubstr("could not be written to its end"));
  // What there was room for is there.
  const ProgramRun exported = run_program({"export", file, "--to", place.path("part")});
  EXPECT_EQ(exported.status, 0) << exported.errors;
}

}  // namespace
}  // namespace softfinger
