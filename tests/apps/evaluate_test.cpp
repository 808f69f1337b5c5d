// `evaluate` as its users call it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;
using Answer = nlohmann::json;

Answer evaluated(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{"evaluate", "--json"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const ProgramRun run = run_program(words);
  EXPECT_EQ(run.status, 0) << run.errors;
  EXPECT_EQ(run.errors, "");
  return Answer::parse(run.output);
}

// A disk renders a plane exactly, so the twin feels what the virtual finger does.
TEST(Evaluate, APlaneIsRenderedFaithfully) {
  const Workplace place;
  const Answer answer = evaluated({place.path("scenes/plane.toml")});
  const Answer& mean = answer.at("mean");
  // Ticks in which one vertex touches first count as well.
  EXPECT_GT(mean.at("iou").get<double>(), 0.89);
  EXPECT_LT(mean.at("normal_force_error").get<double>(), 0.05);
  EXPECT_LT(mean.at("normal_angle_deg").get<double>(), 1.0);
  EXPECT_LT(mean.at("centroid_shift_mm").get<double>(), 0.2);
  EXPECT_EQ(answer.at("frames_missed"), 0);
  EXPECT_GT(answer.at("frames_free"), 10);
  EXPECT_EQ(answer.at("frames_unconverged"), 0);
  const Answer& frames = answer.at("frames");
  // One a device tick: 30 a second, the first at the start.
  EXPECT_NEAR(static_cast<double>(frames.size()), 30.0 * answer.at("steps").get<double>() / 1000.0,
              1.0);
  int free = 0;
  for (const Answer& frame : frames) {
    for (const auto& [name, value] : mean.items()) EXPECT_TRUE(frame.contains(name)) << name;
    EXPECT_TRUE(frame.at("lagged").contains("iou"));
    free += frame.at("iou").is_null() ? 1 : 0;
  }
  EXPECT_EQ(answer.at("frames_free"), free);
  // Servos are late, so what is felt is farther off.
  EXPECT_GT(answer.at("lagged_mean").at("normal_force_error"), mean.at("normal_force_error"));
  for (const Answer& verdict : answer.at("verdict")) {
    EXPECT_EQ(verdict.at("noticeable"), verdict.at("mean") >= verdict.at("threshold"));
    EXPECT_FALSE(verdict.at("source").get<std::string>().empty());
  }
}

double length(double x, double y, double z) { return std::hypot(x, y, z); }

// What the measures say of each frame is what anyone makes of its forces.
TEST(Evaluate, ADeviceThatShearsIsNearerToTheTangentialForce) {
  const Workplace place;
  const auto on_slide = [&](const std::string& device) {
    return evaluated({place.path("scenes/slide.toml"), "--device",
                      place.path("devices/" + device + ".toml"), "--objective", "surface_and_force",
                      "--duration-s", "3.2"});
  };
  const Answer thimble = on_slide("thimble-3rrs");
  const Answer tactor = on_slide("shear-tactor-gleeson");
  for (const Answer& answer : {thimble, tactor}) {
    int compared = 0;
    for (const Answer& frame : answer.at("frames")) {
      const Answer& error = frame.at("tangential_force_error");
      const Answer &v = frame.at("virtual_tangential_N"), &t = frame.at("twin_tangential_N");
      const double force = frame.at("virtual_force_N");
      if (error.is_null()) continue;
      ++compared;
      const double amiss =
          length(t[0].get<double>() - v[0].get<double>(), t[1].get<double>() - v[1].get<double>(),
                 t[2].get<double>() - v[2].get<double>());
      EXPECT_NEAR(error.get<double>(), amiss / std::max(force, 0.05), 1e-9);
      EXPECT_GE(frame.at("slip_ratio_error").get<double>(), 0.0);
      EXPECT_LE(frame.at("slip_ratio_error").get<double>(), 1.02);
    }
    EXPECT_GT(compared, 40);
  }
  const auto mean = [](const Answer& answer) {
    return answer.at("mean").at("tangential_force_error").get<double>();
  };
  EXPECT_LT(mean(tactor), 0.5 * mean(thimble));
  EXPECT_TRUE(thimble.at("lagged_mean").at("tangential_force_error").is_number());
  EXPECT_TRUE(thimble.at("frames").at(60).at("lagged").contains("slip_ratio_error"));
  const ProgramRun text =
      run_program({"evaluate", place.path("scenes/slide.toml"), "--duration-s", "1.2"});
  EXPECT_THAT(text.output, HasSubstr("tangential_force_error"));
  EXPECT_THAT(text.output, HasSubstr("slip_ratio_error"));
}

/// A finger file 5 % larger than the shipped one.
std::string larger_wearer(const Workplace& place) {
  place.write("fingers/larger.toml", place.read("fingers/index.toml") +
                                         "\n[size]\nlength_mm = 26.2\nbreadth_mm = 16.8\n"
                                         "depth_mm = 14.2\n");
  return place.path("fingers/larger.toml");
}

TEST(Evaluate, AWearerOfAnotherSizeFeelsOtherForces) {
  const Workplace place;
  const Answer answer =
      evaluated({place.path("scenes/plane.toml"), "--wearer", larger_wearer(place)});
  EXPECT_GT(answer.at("mean").at("normal_force_error"), 0.5);
  EXPECT_GT(answer.at("mean").at("normal_force_bias"), 0.5);
}

TEST(Evaluate, AForceSensorCorrectsForAnotherWearer) {
  const Workplace place;
  place.write("devices/thimble-3rrs.toml", place.read("devices/thimble-3rrs.toml") +
                                               "\n[force_sensor]\nkind = \"emulator\"\n"
                                               "noise_N = 0.02\n");
  const Answer answer =
      evaluated({place.path("scenes/plane.toml"), "--wearer", larger_wearer(place)});
  EXPECT_LT(answer.at("mean").at("normal_force_error"), 0.3);
}

TEST(Evaluate, SaysInOneLineWhatIsWrong) {
  const Workplace place;
  const std::string scene = place.path("scenes/plane.toml");
  const auto refused = [&](const std::vector<std::string>& words, const std::string& what) {
    std::vector<std::string> arguments{"evaluate"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const ProgramRun run = run_program(arguments);
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(run.output, "");
    EXPECT_EQ(std::ranges::count(run.errors, '\n'), 1) << run.errors;
    EXPECT_THAT(run.errors, HasSubstr(what));
  };
  refused({scene, "--wearer", SOFTFINGER_SOURCE_DIR "/fingers/index-medium.toml"}, "not connected");
  refused({scene, "--duration-s", "-1"}, "--duration-s");
  place.replace_line("scenes/plane.toml", "device", "");
  refused({scene}, "no device");
}

}  // namespace
}  // namespace softfinger
