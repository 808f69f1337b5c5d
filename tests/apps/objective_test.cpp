// What leads a device, as `match` and `evaluate` have it; and whether a tap is felt.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "../support/folders.hpp"
#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using Answer = nlohmann::json;

/// Points of a plane that leans by `pitch_deg` towards the tip, in contact out to 3 mm, and others
/// further out, clear of it by a millimetre.
std::string points_of_plane(double pitch_deg, double height_mm) {
  const double slope = std::tan(pitch_deg * M_PI / 180.0);
  Answer points = Answer::array(), flags = Answer::array();
  for (int i = -3; i <= 3; ++i) {
    for (int j = -3; j <= 3; ++j) {
      const double x = 1.5 * i, y = 1.5 * j;
      const bool touches = std::hypot(x, y) < 3.1;
      points.push_back({x + 1.0, y, height_mm - slope * x + (touches ? 0.0 : 1.0)});
      flags.push_back(touches);
    }
  }
  return Answer{{"points_mm", points}, {"in_contact", flags}}.dump();
}

class Match : public testing::Test {
 protected:
  Match() { place.write("points.json", points_of_plane(6.0, -6.8)); }
  [[nodiscard]] std::vector<std::string> words(const std::string& device,
                                               std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {"match", place.path("devices/" + device + ".toml"), "--points",
                                 place.path("points.json"), "--json"});
    return flags;
  }
  [[nodiscard]] Answer answer(const std::string& device, std::vector<std::string> flags) const {
    const ProgramRun run = run_program(words(device, std::move(flags)));
    EXPECT_EQ(run.status, 0) << run.errors;
    return Answer::parse(run.output);
  }
  Workplace place;
};

TEST_F(Match, EveryObjectiveFindsThePlane) {
  for (const char* objective : {"surface", "published", "plane", "contact_plane"}) {
    const Answer found = answer("thimble-3rrs", {"--objective", objective});
    EXPECT_NEAR(found["configuration"]["pitch_deg"].get<double>(), 6.0, 0.01) << objective;
    EXPECT_NEAR(found["configuration"]["roll_deg"].get<double>(), 0.0, 0.01) << objective;
    EXPECT_LT(found["deviation_mm2"].get<double>(), 1e-6) << objective;
    EXPECT_EQ(found["joints_deg"].size(), 3U);
    EXPECT_EQ(found["termination"], "converged");
    EXPECT_EQ(found["iterations"].get<int>() > 0,
              std::string(objective).find("plane") == std::string::npos)
        << objective;
  }
  const Answer pins = answer("pins-wagner-6x6", {"--objective", "plane"});
  EXPECT_GT(pins["configuration"]["height_0_2_mm"], pins["configuration"]["height_5_2_mm"]);
}

TEST_F(Match, PublishedCutsToLimitsAfterwards) {
  place.write("points.json", points_of_plane(35.0, -6.8));
  const Answer cut = answer("thimble-3rrs", {"--objective", "published"});
  const Answer free = answer("thimble-3rrs", {"--objective", "published", "--limits", "none"});
  const Answer inside = answer("thimble-3rrs", {});
  EXPECT_GT(free["configuration"]["pitch_deg"], 31.0);
  EXPECT_LE(cut["configuration"]["pitch_deg"].get<double>(), 30.001);
  EXPECT_FALSE(cut["joints_deg"].is_null());
  EXPECT_GE(cut["deviation_mm2"].get<double>(), inside["deviation_mm2"].get<double>());
  const Answer plane = answer("thimble-3rrs", {"--objective", "plane"});
  EXPECT_LE(plane["configuration"]["pitch_deg"].get<double>(), 30.001);
  EXPECT_FALSE(plane["joints_deg"].is_null());
}

TEST_F(Match, SaysWhatAnObjectiveCannotHave) {
  const auto refused = [&](std::vector<std::string> flags, const std::vector<std::string>& what) {
    expect_refused(run_program(words("thimble-3rrs", std::move(flags))), what);
  };
  refused({"--objective", "published", "--limits", "inside"}, {"--limits inside", "clamp"});
  refused({"--objective", "published", "--separation", "scene"}, {"--separation", "constant"});
  refused({"--objective", "stress"}, {"--objective"});
}

/// A disk on one servo that turns it: nothing to move along.
constexpr const char* kFlap = R"toml(
kind = "mechanism"
[mount]
translation_mm = [0.0, 0.0, -10.5]
[[body]]
name = "flap"
[[joint]]
name = "hinge"
type = "revolute"
parent = "base"
child = "flap"
origin_mm = [-12.0, 0.0, 0.0]
axis = [0.0, -1.0, 0.0]
actuated = true
joint_deg = [-30.0, 30.0]
[[surface]]
type = "disk"
body = "flap"
origin_mm = [12.0, 0.0, 0.0]
radius_mm = 8.0
[configuration]
turn_deg = { joint = "hinge" }
[limits]
joint_rate_deg_per_s = 400.0
[matching]
objective = "OBJECTIVE"
)toml";

TEST(Objective, ThatADeviceCannotHaveIsOneLine) {
  const Workplace place;
  const auto write_flap = [&](const std::string& objective) {
    std::string text = kFlap;
    text.replace(text.find("OBJECTIVE"), 9, objective);
    place.write("devices/flap.toml", text);
  };
  const std::string flap = place.path("devices/flap.toml");
  const std::vector<std::string> evaluate{
      "evaluate", place.path("scenes/plane.toml"), "--device", flap, "--duration-s", "0.2"};
  const auto with = [&](const char* objective) {
    std::vector<std::string> words = evaluate;
    words.insert(words.end(), {"--objective", objective});
    return run_program(words);
  };
  write_flap("surface");
  EXPECT_EQ(run_program(evaluate).status, 0) << run_program(evaluate).errors;
  EXPECT_EQ(with("published").status, 0);
  expect_refused(with("plane"), {"flap.toml", "plane", "length", "surface, "});
  expect_refused(with("fun"), {"--objective", "fun"});
  write_flap("plane");
  expect_refused(run_program(evaluate), {"flap.toml:26", "matching.objective", "plane", "length"});
  place.replace_line("scenes/plane.toml", "device", "device = \"../devices/flap.toml\"");
  expect_refused(run_program({"scene", "check", place.path("scenes/plane.toml")}),
                 {"flap.toml:26", "matching.objective"});
}

/// A tap: down in `down_s` onto a plane, and held there for 0.3 s.
struct Tap {
  const char* finger;
  const char* device;
  const char* objective;
  double down_s;
};

std::ostream& operator<<(std::ostream& out, const Tap& tap) {
  return out << tap.finger << " on " << tap.device << ", " << tap.objective << ", " << tap.down_s;
}

class Taps : public testing::TestWithParam<Tap> {};

std::vector<Tap> taps() {
  std::vector<Tap> all;
  for (const auto& [finger, device] :
       {std::pair{"index", "thimble-3rrs"}, std::pair{"pinky", "thimble-3rrs"},
        std::pair{"pinky", "pins-wagner-6x6"}, std::pair{"pinky", "membrane"},
        std::pair{"index", "plate-2dof"}}) {
    for (const double down : {0.12, 0.14, 0.2, 0.28, 0.4}) {
      all.push_back({finger, device, "surface", down});
    }
    all.push_back({finger, device, "surface_and_force", 0.14});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, Taps, testing::ValuesIn(taps()));

// Found by use: taps that a device answered a fifth of a second late, or never. What is commanded
// is felt two ticks after the virtual finger feels it, and as firmly.
TEST_P(Taps, IsFelt) {
  const Tap tap = GetParam();
  const Workplace place;
  std::string scene = fmt::format(
      "[[finger]]\nname = \"finger\"\nmodel = \"{0}/fingers/{1}.toml\"\n"
      "device = \"{0}/devices/{2}.toml\"\n",
      source_folder(), tap.finger, tap.device);
  for (const auto& [time, height] :
       {std::pair{0.0, 20.5}, std::pair{0.3, 20.5}, std::pair{0.3 + tap.down_s, 5.2},
        std::pair{0.6 + tap.down_s, 5.2}}) {
    scene += fmt::format(
        "[[finger.waypoint]]\ntime_s = {}\nposition_mm = [0.0, 0.0, {}]\n"
        "rotation_vector_deg = [0.0, 6.0, 0.0]\n",
        time, height);
  }
  place.write("scenes/tap.toml",
              scene + "[[object]]\nshape = \"plane\"\nfriction_coefficient = 0.5\n");
  const ProgramRun run = run_program(
      {"evaluate", place.path("scenes/tap.toml"), "--json", "--objective", tap.objective});
  ASSERT_EQ(run.status, 0) << run.errors;
  const Answer frames = Answer::parse(run.output).at("frames");
  const auto first = [&](const char* side) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (frames[i][side].get<double>() > 0.05) return static_cast<int>(i);
    }
    return 1000;
  };
  const int touched = first("virtual_force_N");
  ASSERT_LT(touched, 1000);
  EXPECT_LE(first("twin_force_N"), touched + 2);
  const double wanted = frames.back()["virtual_force_N"], felt = frames.back()["twin_force_N"];
  EXPECT_GT(wanted, 0.3);
  EXPECT_GT(felt, 0.8 * wanted);
  EXPECT_LT(felt, 1.6 * wanted);
}

}  // namespace
}  // namespace softfinger
