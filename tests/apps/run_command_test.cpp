#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sqlite3.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json parse(const ProgramRun& run) {
  EXPECT_EQ(run.status, 0) << run.errors;
  return json::parse(run.output);
}

void execute_sql(const std::string& file, const char* sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
}

TEST(RunCommand, HeadlessAnswersInJson) {
  const Workplace place;
  const json run = parse(run_program({"run", place.path("scenes/sphere.toml"), "--headless",
                                      "--duration-s", "2", "--as-fast-as-possible", "--json"}));
  EXPECT_EQ(run.at("steps"), 2000);
  for (const char* key :
       {"step_ms", "match_ms", "step_wall_ms", "latency_ms", "pose_age_ms", "iterations"}) {
    for (const char* value : {"p50", "p99", "max"}) {
      EXPECT_TRUE(run.at(key).at(value).is_number()) << key << " " << value;
      EXPECT_TRUE(run.at("fingers").at("index").at(key).at(value).is_number()) << key;
    }
  }
  // A script's poses arrive from nowhere, and nothing is written to a port.
  const json& stages = run.at("latency_stages_ms");
  for (const char* unknown : {"exposure", "arrival", "send", "servo"}) {
    EXPECT_TRUE(stages.at(unknown).is_null()) << unknown;
  }
  for (const char* known : {"step", "match"}) {
    int counted = 0;
    for (const json& bin : stages.at(known).at("histogram")) counted += bin.at("count").get<int>();
    EXPECT_EQ(counted, 61) << known;
  }
  EXPECT_TRUE(run.at("deadline_misses").is_null());
  EXPECT_TRUE(run.at("recording").is_null());
  EXPECT_EQ(run.at("unconverged_steps"), 0);
  // 61 ticks, then until 0.3 s after the retracted pose is reached.
  EXPECT_GE(run.at("commands_sent"), 61 + 9);
  EXPECT_GT(run.at("max_contact_area_mm2"), 1.0);
  EXPECT_GT(run.at("max_normal_force_N"), 0.05);
}

TEST(RunCommand, EndsWithItsScript) {
  const Workplace place;
  place.write("scenes/poses.csv",
              "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,0,0,40,1,0,0,0\n0.15,0,0,40,1,0,0,0\n"
              "0.3,0,0,39,1,0,0,0\n");
  const json run =
      parse(run_program({"run", place.path("scenes/sphere.toml"), "--headless", "--tracker",
                         "csv:" + place.path("scenes/poses.csv"), "--json"}));
  EXPECT_EQ(run.at("steps"), 300);
  EXPECT_TRUE(run.at("deadline_misses").is_number());
}

TEST(RunCommand, RecordsReplaysAndExports) {
  const Workplace place;
  const std::string file = place.path("run.db");
  const std::vector<std::string> command = {
      "run",   place.path("scenes/edge.toml"), "--headless", "--duration-s",
      "1.5",   "--as-fast-as-possible",        "--record",   file,
      "--json"};
  EXPECT_EQ(parse(run_program(command)).at("recording"), file);
  const ProgramRun again = run_program(command);
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.errors, HasSubstr("exists already"));

  const json good = parse(run_program({"replay", file, "--json"}));
  EXPECT_TRUE(good.at("agree"));
  EXPECT_EQ(good.at("steps"), 1500);
  EXPECT_TRUE(good.at("first_difference").is_null());

  EXPECT_EQ(run_program({"export", file, "--to", place.path("csv")}).status, 0);
  EXPECT_THAT(place.read("csv/pose.csv"), HasSubstr("time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,"));

  execute_sql(file, "update steps set x_m = x_m + 1e-9 where step = 321");
  const ProgramRun altered = run_program({"replay", file, "--json"});
  EXPECT_EQ(altered.status, 1);
  EXPECT_FALSE(json::parse(altered.output).at("agree"));
  EXPECT_EQ(json::parse(altered.output).at("first_difference"), 321);
}

TEST(RunCommand, KilledRecordingIsWhole) {
  const Workplace place;
  RunningProgram program(
      {"run", place.path("scenes/plane.toml"), "--headless", "--record", place.path("run.db")});
  for (int i = 0; i < 2000 && !std::filesystem::exists(place.path("run.db")); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  EXPECT_EQ(program.stop(SIGKILL).status, 128 + SIGKILL);
  const json replay = parse(run_program({"replay", place.path("run.db"), "--json"}));
  EXPECT_TRUE(replay.at("agree"));
  EXPECT_GT(replay.at("steps"), 100);
}

TEST(RunCommand, InterruptEndsCleanly) {
  const Workplace place;
  RunningProgram program({"run", place.path("scenes/sphere.toml"), "--port", "0", "--repeat",
                          "--record", place.path("run.db")});
  ASSERT_TRUE(program.says("http://127.0.0.1:", 20.0));
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  const ProgramRun run = program.stop(SIGINT);
  EXPECT_EQ(run.status, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("commands sent"));
  EXPECT_EQ(run_program({"replay", place.path("run.db")}).status, 0);
}

// As a service manager and a closed terminal do; nohup is told apart.
TEST(RunCommand, TerminateAndHangUpEndCleanly) {
  const Workplace place;
  const std::vector<std::string> command{"run", place.path("scenes/sphere.toml"), "--headless",
                                         "--record"};
  for (const int signal : {SIGTERM, SIGHUP}) {
    std::vector<std::string> words = command;
    words.push_back(place.path("run" + std::to_string(signal) + ".db"));
    RunningProgram program(words);
    for (int i = 0; i < 1000 && !std::filesystem::exists(words.back()); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const ProgramRun run = program.stop(signal);
    EXPECT_EQ(run.status, 0) << signal << run.errors;
    EXPECT_THAT(run.output, HasSubstr("commands sent"));
    EXPECT_EQ(run_program({"replay", words.back()}).status, 0);
  }
  std::vector<std::string> words = command;
  words.insert(words.end(), {place.path("nohup.db"), "--duration-s", "1"});
  RunningProgram program(words, R"(trap "" HUP; exec "$@")");
  for (int i = 0; i < 1000 && !std::filesystem::exists(place.path("nohup.db")); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_THAT(program.stop(SIGHUP).output, testing::StartsWith("1000 steps"));
}

TEST(RunCommand, PortInUseIsSaidAndLeavesNothing) {
  const Workplace place;
  RunningProgram first({"run", place.path("scenes/sphere.toml"), "--port", "18537", "--repeat"});
  ASSERT_TRUE(first.says("http://127.0.0.1:18537", 20.0));
  const ProgramRun second = run_program({"run", place.path("scenes/sphere.toml"), "--port", "18537",
                                         "--record", place.path("run.db")});
  EXPECT_EQ(second.status, 2);
  EXPECT_THAT(second.errors, HasSubstr("18537"));
  EXPECT_FALSE(std::filesystem::exists(place.path("run.db")));
  EXPECT_EQ(first.stop(SIGINT).status, 0);
}

TEST(RunCommand, RefusesWhatDoesNotFitTogether) {
  const Workplace place;
  const std::string scene = place.path("scenes/sphere.toml");
  for (const std::vector<std::string>& flags :
       std::vector<std::vector<std::string>>{{"--as-fast-as-possible"},
                                             {"--headless", "--record-state"},
                                             {"--headless", "--repeat"},
                                             {"--headless", "--no-twin"},
                                             {"--headless", "--tracker", "page"},
                                             {"--headless", "--listen", "127.0.0.1"},
                                             {"--headless", "--token", "/no/such/token"},
                                             {"--headless", "--plain-http"},
                                             {"--plain-http", "--certificate", "/c", "--key", "/k"},
                                             {"--token", "/no/such/token"},
                                             {"--headless", "--duration-s", "-1"},
                                             {"--headless", "--duration-s", "nan"},
                                             {"--headless", "--predict-ms", "-1"},
                                             {"--headless", "--predict-ms", "51"},
                                             {"--headless", "--simd", "mmx"},
                                             {"--headless", "--tracker", "crystal-ball"},
                                             {"--headless", "--device", "/no/such/device.toml"},
                                             {"--port", "70000"}}) {
    std::vector<std::string> command = {"run", scene};
    command.insert(command.end(), flags.begin(), flags.end());
    const ProgramRun run = run_program(command);
    EXPECT_EQ(run.status, 2) << flags.back();
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_EQ(run.output, "") << flags.back();
  }
}

TEST(RunCommand, WhatIsNoRecordingIsRefused) {
  const Workplace place;
  for (const std::string& file : {place.path("scenes/sphere.toml"), place.path("nothing.db")}) {
    for (const std::vector<std::string>& command :
         std::vector<std::vector<std::string>>{{"replay", file}, {"export", file, "--to", "x"}}) {
      const ProgramRun run = run_program(command);
      EXPECT_EQ(run.status, 2);
      EXPECT_THAT(run.errors, HasSubstr(file));
      EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    }
  }
}

}  // namespace
}  // namespace softfinger
