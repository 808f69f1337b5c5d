// `evaluate` as its users call it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../support/folders.hpp"
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
  EXPECT_GT(mean.at("iou").get<double>(), 0.88);
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

/// The thimble with motors that hold `torque`.
std::string thimble_that_holds(const Workplace& place, const std::string& torque) {
  std::ifstream shipped(place.path("devices/thimble-3rrs.toml"));
  std::string text{std::istreambuf_iterator<char>(shipped), {}};
  const std::string before = "torque_N_mm = 78.0";
  const std::size_t at = text.find(before);
  EXPECT_NE(at, std::string::npos);
  text.replace(at, before.size(), "torque_N_mm = " + torque);
  place.write("devices/held.toml", text);
  return place.path("devices/held.toml");
}

// What motors yield by is judged, and what they cannot hold is told.
TEST(Evaluate, MotorsUnderLoad) {
  const Workplace place;
  const auto on_sphere = [&](const std::string& torque) {
    return evaluated({place.path("scenes/sphere.toml"), "--device",
                      thimble_that_holds(place, torque), "--duration-s", "3"});
  };
  const Answer strong = on_sphere("78.0");
  EXPECT_EQ(strong.at("frames_not_held"), 0);
  EXPECT_EQ(strong.at("frames_unconverged"), 0);
  int loaded = 0;
  for (const Answer& frame : strong.at("frames")) {
    EXPECT_EQ(frame.at("motors_hold"), true);
    if (frame.at("twin_force_N") < 0.1) continue;
    EXPECT_GT(frame.at("motor_torque_N_mm"), 0.1);
    EXPECT_LT(frame.at("motor_torque_N_mm"), 78.0);
    ++loaded;
  }
  EXPECT_GT(loaded, 20);
  EXPECT_GT(strong.at("loaded_mean").at("normal_force_error"),
            strong.at("mean").at("normal_force_error"));
  const Answer weak = on_sphere("1.0");
  EXPECT_GT(weak.at("frames_not_held"), 20);
  EXPECT_GT(weak.at("loaded_mean").at("normal_force_error"),
            strong.at("loaded_mean").at("normal_force_error"));
  for (const Answer& frame : weak.at("frames")) {
    EXPECT_LE(frame.at("motor_torque_N_mm").get<double>(), 1.0 + 1e-9);
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
  const Answer answer = evaluated(
      {place.path("scenes/plane.toml"), "--duration-s", "3.5", "--wearer", larger_wearer(place)});
  EXPECT_GT(answer.at("mean").at("normal_force_error"), 0.5);
  EXPECT_GT(answer.at("mean").at("normal_force_bias"), 0.5);
}

TEST(Evaluate, AForceSensorCorrectsForAnotherWearer) {
  const Workplace place;
  place.write("devices/thimble-3rrs.toml", place.read("devices/thimble-3rrs.toml") +
                                               "\n[force_sensor]\nkind = \"emulator\"\n"
                                               "noise_N = 0.02\n");
  const Answer answer = evaluated(
      {place.path("scenes/plane.toml"), "--wearer", larger_wearer(place), "--duration-s", "3"});
  EXPECT_LT(answer.at("mean").at("normal_force_error"), 0.3);
}

std::string shipped_finger(const std::string& name) {
  return source_folder() + "/fingers/" + name + ".toml";
}

double mean_of(const Answer& answer, const char* measure) {
  return answer.at("mean").at(measure).get<double>();
}

// The same shape and constants in elements a third as large: what is felt hardly differs.
TEST(Evaluate, TheMeasuresHardlyDependOnTheWearersMesh) {
  const Workplace place;
  const std::string scene = place.path("scenes/plane.toml");
  for (const char* objective : {"surface", "surface_and_force"}) {
    const std::vector<std::string> words{scene, "--objective", objective, "--duration-s", "2.4"};
    const Answer same = evaluated(words);
    std::vector<std::string> with_wearer = words;
    with_wearer.insert(with_wearer.end(), {"--wearer", shipped_finger("index-medium")});
    const Answer medium = evaluated(with_wearer);
    EXPECT_GT(mean_of(same, "iou"), 0.85);
    EXPECT_NEAR(mean_of(medium, "iou"), mean_of(same, "iou"), 0.05) << objective;
    EXPECT_NEAR(mean_of(medium, "normal_force_error"), mean_of(same, "normal_force_error"), 0.05)
        << objective;
    EXPECT_LT(mean_of(medium, "centroid_shift_mm"), mean_of(same, "centroid_shift_mm") + 0.2);
    EXPECT_LT(mean_of(medium, "pressure_error"), mean_of(same, "pressure_error") + 0.2);
    EXPECT_LT(mean_of(medium, "strain_energy_density_error"), 0.4);
    EXPECT_EQ(medium.at("frames_unconverged"), 0);
  }
}

TEST(Evaluate, AnyFingerMayWearTheDevice) {
  const Workplace place;
  for (const char* name : {"index-layered", "index-viscoelastic", "middle"}) {
    const Answer answer = evaluated(
        {place.path("scenes/plane.toml"), "--duration-s", "1.8", "--wearer", shipped_finger(name)});
    int both = 0;
    for (const Answer& frame : answer.at("frames")) {
      if (!(frame.at("virtual_force_N") > 0.05) || !(frame.at("twin_force_N") > 0.05)) continue;
      ++both;
      for (const auto& [measure, value] : answer.at("mean").items()) {
        EXPECT_TRUE(frame.at(measure).is_number()) << name << " " << measure;
      }
      EXPECT_GT(frame.at("iou"), 0.3) << name;
    }
    EXPECT_GE(both, 10) << name;
  }
}

// A live run has a wearer too: for the emulated sensor, which corrects for what it feels.
TEST(Evaluate, ASensorMayBeOnAFingerOfAnotherMesh) {
  const Workplace place;
  place.write("devices/thimble-3rrs.toml",
              place.read("devices/thimble-3rrs.toml") + "\n[force_sensor]\nkind = \"emulator\"\n");
  const ProgramRun run =
      run_program({"run", place.path("scenes/plane.toml"), "--headless", "--as-fast-as-possible",
                   "--duration-s", "1.5", "--wearer", shipped_finger("index-medium"), "--json"});
  EXPECT_EQ(run.status, 0) << run.errors;
  EXPECT_EQ(Answer::parse(run.output).at("steps"), 1500);
}

// What people tell soft from hard by.
TEST(Evaluate, ContactSpreadsFasterOverASpongeThanOverATable) {
  const Workplace place;
  const std::string plate = place.path("devices/plate-6dof.toml");
  const Answer table =
      evaluated({place.path("scenes/plane.toml"), "--device", plate, "--duration-s", "3"});
  const Answer sponge =
      evaluated({source_folder() + "/scenes/sponge.toml", "--device", "index=" + plate, "--device",
                 "thumb=" + plate, "--duration-s", "1.6"});
  const auto rate = [](const Answer& answer, std::size_t finger, const char* side) {
    return answer.at("area_spread_rate").at(finger).at(side).get<double>();
  };
  const double hard = rate(table, 0, "virtual_mm2_per_N");
  EXPECT_GT(hard, 0.0);
  EXPECT_NEAR(rate(table, 0, "twin_mm2_per_N"), hard, 0.1 * hard) << "a plate is a table";
  ASSERT_EQ(sponge.at("area_spread_rate").size(), 2U);
  for (const std::size_t finger : {0U, 1U}) {
    EXPECT_TRUE(sponge.at("area_spread_rate").at(finger).at("finger").is_string());
    const double soft = rate(sponge, finger, "virtual_mm2_per_N");
    EXPECT_GT(soft, 1.3 * hard);
    EXPECT_LT(rate(sponge, finger, "twin_mm2_per_N"), soft) << "a rigid plate";
  }
  double most = 0.0;
  for (const Answer& frame : table.at("frames")) {
    most = std::max(most, frame.at("virtual_contact_area_mm2").get<double>());
    if (frame.at("twin_force_sum_N") > 0.05) {
      EXPECT_GT(frame.at("twin_contact_area_mm2"), 1.0);
    }
  }
  EXPECT_GT(most, 30.0);
}

// Contact between samples leaves C empty, and presses all the same.
TEST(Evaluate, NoFrameInWhichBothSidesPressIsMissed) {
  const Workplace place;
  const Answer answer = evaluated({place.path("scenes/edge.toml"), "--device",
                                   place.path("devices/delta-schorr.toml"), "--duration-s", "4"});
  int missed = 0, false_ones = 0, free = 0, both = 0;
  for (const Answer& frame : answer.at("frames")) {
    const bool v = frame.at("virtual_force_sum_N") > 0.01, t = frame.at("twin_force_sum_N") > 0.01;
    const bool is_free = frame.at("iou").is_null() && frame.at("normal_force_error").is_null();
    const bool one_sided = !is_free && frame.at("normal_force_error").is_null();
    if (v || t) {
      EXPECT_FALSE(is_free) << frame.at("time_s");
    }
    if (v && t) {
      EXPECT_FALSE(one_sided) << frame.at("time_s");
      EXPECT_TRUE(frame.at("iou").is_number()) << frame.at("time_s");
      ++both;
    }
    if (one_sided) ++(frame.at("virtual_force_sum_N") > 0.0 ? missed : false_ones);
    if (is_free) ++free;
  }
  EXPECT_GT(both, 20);
  EXPECT_EQ(answer.at("frames_free"), free);
  EXPECT_EQ(answer.at("frames_missed").get<int>() + answer.at("frames_false").get<int>(),
            missed + false_ones);
}

/// The shipped finger without the skin of triangles that `bare` holds of, by their centroid (mm).
template <typename Bare>
std::string partly_bare(const Workplace& place, const std::string& name, const Bare& bare) {
  std::istringstream in(place.read("fingers/index.msh"));
  std::map<int, std::array<double, 3>> nodes;
  std::string text, section;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    if (line.starts_with('$')) section = line;
    if (section == "$Nodes") {
      int number = 0;
      std::array<double, 3> p{};
      if (words >> number >> p[0] >> p[1] >> p[2]) nodes[number] = p;
    }
    int number = 0, type = 0, tags = 0, group = 0, entity = 0;
    std::array<int, 3> corners{};
    if (section == "$Elements" &&
        words >> number >> type >> tags >> group >> entity >> corners[0] >> corners[1] >>
            corners[2] &&
        type == 2 && group == 1) {
      std::array<double, 3> centroid{};
      for (const int corner : corners) {
        for (std::size_t k = 0; k < 3; ++k) centroid[k] += nodes.at(corner)[k] / 3.0;
      }
      if (bare(centroid)) {
        line =
            fmt::format("{} 2 2 4 {} {} {} {}", number, entity, corners[0], corners[1], corners[2]);
      }
    }
    text += line + "\n";
  }
  place.write("fingers/" + name + ".msh", text);
  place.write("fingers/" + name + ".toml", place.read("fingers/index.toml"));
  place.replace_line("fingers/" + name + ".toml", "file", "file = \"" + name + ".msh\"");
  return place.path("fingers/" + name + ".toml");
}

void expect_refused(const std::vector<std::string>& words, const std::string& what) {
  std::vector<std::string> arguments{"evaluate"};
  arguments.insert(arguments.end(), words.begin(), words.end());
  const ProgramRun run = run_program(arguments);
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.output, "");
  EXPECT_EQ(std::ranges::count(run.errors, '\n'), 1) << run.errors;
  EXPECT_THAT(run.errors, HasSubstr(what));
}

TEST(Evaluate, AWearerWithoutSkinWhereTheModelIsTouchedIsRefused) {
  const Workplace place;
  const std::string scene = place.path("scenes/plane.toml");
  const auto bare_from = [&](const std::string& name, double x_mm) {
    return partly_bare(place, name, [x_mm](const auto& p) { return p[0] > x_mm; });
  };
  const std::string little = bare_from("little", -6.0);
  expect_refused({scene, "--wearer", little}, little + ": its skin covers");
  // Where this scene touches there is none, though on most of the pad there is.
  const std::string proximal = bare_from("proximal", 3.0);
  expect_refused({scene, "--wearer", proximal}, proximal + ": its skin does not cover where");
  const std::string pad = partly_bare(place, "pad", [](const auto& p) { return p[2] > -2.0; });
  const Answer answer = evaluated({scene, "--duration-s", "1.6", "--wearer", pad});
  EXPECT_GT(mean_of(answer, "iou"), 0.85);
}

TEST(Evaluate, SaysInOneLineWhatIsWrong) {
  const Workplace place;
  const std::string scene = place.path("scenes/plane.toml");
  expect_refused({scene, "--duration-s", "-1"}, "--duration-s");
  place.replace_line("scenes/plane.toml", "device", "");
  expect_refused({scene}, "no device");
}

}  // namespace
}  // namespace softfinger
