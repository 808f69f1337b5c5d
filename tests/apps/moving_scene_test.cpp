// Scenes of objects that move: without a finger checked, run, replayed and exported; and the
// shipped ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>
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

TEST(MovingScene, KilledRecordingReplaysAsFarAsItGoes) {
  const Workplace place;
  const std::string file = place.path("run.sqlite");
  RunningProgram program({"run", "tower", "--headless", "--as-fast-as-possible", "--duration-s",
                          "600", "--record", file});
  const auto size = [&] {
    std::error_code error;
    const auto bytes = std::filesystem::file_size(file + "-wal", error);
    return error ? 0 : bytes;
  };
  for (int i = 0; i < 1000 && size() < 400000; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(program.stop(SIGKILL).status, 128 + SIGKILL);
  const json replay = json::parse(run_program({"replay", file, "--json"}).output);
  EXPECT_TRUE(replay.at("agree"));
  EXPECT_GT(replay.at("steps"), 100);
}

TEST(MovingScene, EventsAreExported) {
  const Workplace place;
  place.write("scenes/drop.toml", R"([[object]]
name = "table"
shape = "plane"
[[object]]
name = "ball"
shape = "sphere"
radius_mm = 5
position_mm = [0, 0, 10]
motion = "dynamic"
mass_g = 3
)");
  const std::string file = place.path("drop.sqlite");
  ASSERT_EQ(run_program({"run", place.path("scenes/drop.toml"), "--headless",
                         "--as-fast-as-possible", "--duration-s", "0.2", "--record", file})
                .status,
            0);
  ASSERT_EQ(run_program({"export", file, "--to", place.path("csv")}).status, 0);
  std::istringstream rows(place.read("csv/events.csv"));
  std::string header;
  std::string row;
  std::getline(rows, header);
  EXPECT_EQ(header, "time_s,kind,object,other,impulse_N_s");
  ASSERT_TRUE(std::getline(rows, row));
  // Free fall of 5 mm takes 31.9 ms, and ends with m sqrt(2 g h); its weight adds in 10 ms.
  double time = 0.0;
  double impulse = 0.0;
  ASSERT_EQ(std::sscanf(row.c_str(), "%lf,impact,table,ball,%lf", &time, &impulse), 2) << row;
  EXPECT_NEAR(time, 0.032, 0.0021);
  EXPECT_NEAR(impulse, 3e-3 * (0.313 + 0.0981), 0.05e-3);
  EXPECT_FALSE(std::getline(rows, row)) << row;
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

/// Objects of a shipped scene after `seconds` of it.
json objects_of(const char* scene, const char* seconds, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{"run",          scene,   "--headless", "--as-fast-as-possible",
                                 "--duration-s", seconds, "--json"};
  words.insert(words.end(), more.begin(), more.end());
  const ProgramRun done = run_program(words);
  EXPECT_EQ(done.status, 0) << done.errors;
  const json answer = json::parse(done.output);
  EXPECT_EQ(answer.at("unconverged_steps"), 0);
  return answer.at("objects");
}

double place_mm(const json& objects, const char* name, std::size_t axis) {
  return objects.at(name).at("position_mm")[axis].get<double>();
}

TEST(MovingScene, ButtonSnapsThroughItsDome) {
  // Pressed by a finger that is soft itself it does not stay between top and valley.
  EXPECT_LT(objects_of("button", "3").at("button").at("joint").get<double>(), -1.4);
}

TEST(MovingScene, KnobRestsOnADetentWhereItIsLeft) {
  const double angle = objects_of("knob", "6.2").at("knob").at("joint").get<double>();
  // Dry friction of 0.5 N mm holds within asin(0.5 / 4) / 24 of one of the 24.
  EXPECT_NEAR(angle, 15.0, 0.31);
}

TEST(MovingScene, DrawerFollowsItsHandleAndStaysWhereItIsLeft) {
  const json objects = objects_of("drawer", "3.6");
  EXPECT_GT(objects.at("drawer").at("joint").get<double>(), 25.0);
  EXPECT_LT(objects.at("drawer").at("joint").get<double>(), 40.0);
  EXPECT_NEAR(place_mm(objects, "handle", 0) - place_mm(objects, "drawer", 0), 86.0, 1e-9);
}

TEST(MovingScene, UppermostBlockOfATowerStaysWhereItWasPushed) {
  const json objects = objects_of("tower", "4");
  EXPECT_LT(place_mm(objects, "block_5", 0), -5.0);
  EXPECT_NEAR(place_mm(objects, "block_5", 2), 90.0, 0.02);
  EXPECT_NEAR(place_mm(objects, "block_4", 0), 0.0, 0.02);
  EXPECT_NEAR(place_mm(objects, "block_1", 2), 10.0, 0.005);
}

TEST(MovingScene, PendulumSwingsByItsLengthAndDamping) {
  // Left to itself after 2 s: seven periods apart it is where it was, less what damping took.
  const double inertia = 0.05 * (0.12 * 0.12 + 0.4 * 0.02 * 0.02);
  const double period = 2.0 * std::numbers::pi * std::sqrt(inertia / (0.05 * 9.81 * 0.12));
  const double later = 3.0 + 7.0 * period;
  const auto angle = [](double time) {
    return objects_of("pendulum", std::to_string(time).c_str()).at("bob").at("joint").get<double>();
  };
  const double start = angle(3.0);
  EXPECT_GT(start, 2.0);
  EXPECT_NEAR(angle(later), start * std::exp(-0.5 * 1e-4 / inertia * 7.0 * period), 0.35);
}

TEST(MovingScene, CupHangsBetweenTwoFingers) {
  EXPECT_NEAR(place_mm(objects_of("cup", "3.6"), "cup", 2), 79.0, 1.0);
}

TEST(MovingScene, WholeHandLiftsABottle) {
  const json objects = objects_of("bottle", "3.4");
  EXPECT_NEAR(place_mm(objects, "bottle", 2), 121.6, 2.0);
  // It has wrapped around it: thumb and fingers are on both sides, with the palm between.
  EXPECT_LT(place_mm(objects, "right-thumb-proximal", 0), -20.0);
  EXPECT_GT(place_mm(objects, "right-index-proximal", 0), 20.0);
  EXPECT_NEAR(place_mm(objects, "right-middle-metacarpal", 2) - 2.0, 128.0, 5.0);
}

TEST(MovingScene, BallIsHandedFromTheIndexToTheMiddleFinger) {
  EXPECT_NEAR(place_mm(objects_of("handover", "4.4"), "ball", 2), 53.5, 2.0);
}

TEST(MovingScene, HandIsCheckedAndSaysHowItFollows) {
  const ProgramRun text = run_program({"scene", "check", "bottle"});
  EXPECT_EQ(text.status, 0) << text.errors;
  EXPECT_THAT(text.output, HasSubstr("hand right: right, 14 bones, each pulled by at most 20 N"));
  const json answer = json::parse(run_program({"scene", "check", "bottle", "--json"}).output);
  EXPECT_EQ(answer.at("hands")[0].at("tracker"), "script");
  EXPECT_EQ(answer.at("hands")[0].at("duration_s"), 6.0);
  EXPECT_EQ(answer.at("duration_s"), 6.0);
  EXPECT_EQ(answer.at("objects").back().at("hand"), "right");
}

TEST(MovingScene, SpongeIsLiftedAndSetDown) {
  const Workplace place;
  const std::string file = place.path("sponge.sqlite");
  const json set_down = objects_of("sponge", "6", {"--record", file});
  ASSERT_EQ(run_program({"export", file, "--to", place.path("csv")}).status, 0);
  std::istringstream rows(place.read("csv/objects.csv"));
  std::string header;
  std::string row;
  std::getline(rows, header);
  ASSERT_TRUE(header.starts_with("time_s,object,x_mm,y_mm,z_mm,")) << header;
  while (std::getline(rows, row) && !row.starts_with("2.3,sponge,")) continue;
  double height = 0.0;
  ASSERT_EQ(std::sscanf(row.c_str(), "2.3,sponge,%*f,%*f,%lf", &height), 1) << row;
  EXPECT_NEAR(height, 40.0, 1.5);
  EXPECT_NEAR(place_mm(set_down, "sponge", 2), 10.0, 0.05);
  EXPECT_TRUE(set_down.at("sponge").at("joint").is_null());
}

}  // namespace
}  // namespace softfinger
