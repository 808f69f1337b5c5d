// `finger fit` as its users call it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "../support/folders.hpp"
#include "program.hpp"
#include "workplace.hpp"

namespace softfinger {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class FingerFitCommand : public testing::Test {
 protected:
  [[nodiscard]] std::string finger() const { return place_.path("fingers/index.toml"); }

  /// A press of the finger itself with another modulus: what a test bench could have measured.
  [[nodiscard]] std::string curve_with_modulus(const std::string& kPa, double to_mm) const {
    place_.write("fingers/other.toml", place_.read("fingers/index.toml"));
    place_.replace_line("fingers/other.toml", "youngs_modulus_kPa", "youngs_modulus_kPa = " + kPa);
    const ProgramRun press = run_program({"press", place_.path("fingers/other.toml"), "--to-mm",
                                          std::to_string(to_mm), "--steps", "12", "--json"});
    std::string text = "indentation_mm,force_N\n";
    double sign = 1.0;
    for (const json& row : json::parse(press.output)) {
      sign = -sign;
      text += row["indentation_mm"].dump() + "," +
              std::to_string(row["normal_force_N"].get<double>() * (1.0 + 0.01 * sign)) + "\n";
    }
    return text;
  }

  [[nodiscard]] ProgramRun fit(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"finger",
                                   "fit",
                                   finger(),
                                   "--data",
                                   place_.path("curve.csv"),
                                   "--out",
                                   place_.path("fitted.toml")};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }

  void expect_refused(const std::string& curve, const std::vector<std::string>& words,
                      const std::vector<std::string>& more = {}) const {
    place_.write("curve.csv", curve);
    const ProgramRun run = fit(more);
    EXPECT_EQ(run.status, 2) << run.errors;
    EXPECT_EQ(run.output, "");
    EXPECT_EQ(std::ranges::count(run.errors, '\n'), 1) << run.errors;
    for (const std::string& word : words) EXPECT_THAT(run.errors, HasSubstr(word));
    EXPECT_NE(run_program({"finger", "show", place_.path("fitted.toml")}).status, 0);
  }

  Workplace place_;
};

TEST_F(FingerFitCommand, WritesAFingerWithTheFittedModulus) {
  place_.write("curve.csv", curve_with_modulus("33.0", 0.5));
  const ProgramRun run = fit({"--parameters", "youngs_modulus_kPa", "--json"});
  ASSERT_EQ(run.status, 0) << run.errors;
  EXPECT_EQ(run.errors, "");
  const json answer = json::parse(run.output);
  const json& modulus = answer["parameters"]["youngs_modulus_kPa"];
  EXPECT_NEAR(modulus["value"].get<double>(), 33.0, 1.0);
  EXPECT_LT(modulus["ci95_low"], modulus["value"]);
  EXPECT_GT(modulus["ci95_high"], modulus["value"]);
  EXPECT_TRUE(answer["kept"].contains("min"));
  EXPECT_TRUE(answer["kept"].contains("max"));

  // The file is complete, finds its mesh from where it lies, and differs in the modulus only.
  const auto show = [&](const std::string& file) {
    const ProgramRun shown = run_program({"finger", "show", file, "--json"});
    EXPECT_EQ(shown.status, 0) << shown.errors;
    return json::parse(shown.output);
  };
  json fitted = show(place_.path("fitted.toml"));
  json original = show(finger());
  EXPECT_NEAR(fitted["material"]["youngs_modulus_kPa"].get<double>(),
              modulus["value"].get<double>(), 1e-3);
  EXPECT_EQ(fitted["mesh"]["file"], "fingers/index.msh");
  for (json* file : {&fitted, &original}) {
    (*file)["material"].erase("youngs_modulus_kPa");
    (*file)["mesh"].erase("file");
  }
  EXPECT_EQ(fitted, original);
  EXPECT_THAT(place_.read("fitted.toml"), HasSubstr("curve.csv"));
}

TEST_F(FingerFitCommand, NeverOverwrites) {
  place_.write("fitted.toml", "precious");
  place_.write("curve.csv", curve_with_modulus("30.0", 0.4));
  const ProgramRun run = fit();
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.errors, HasSubstr("fitted.toml: exists already"));
  EXPECT_EQ(place_.read("fitted.toml"), "precious");
}

TEST_F(FingerFitCommand, KeepsTheTermsOfRelaxation) {
  place_.write("curve.csv", curve_with_modulus("40.0", 0.4));
  place_.write("fingers/index.toml",
               place_.read("fingers/index.toml") +
                   "\n[[material.relaxation]]\ntime_ms = 70.0\nfraction = 0.25\n"
                   "\n[[material.relaxation]]\ntime_ms = 1400.0\nfraction = 0.2\n");
  const ProgramRun run = fit({"--parameters", "youngs_modulus_kPa"});
  ASSERT_EQ(run.status, 0) << run.errors;
  const auto relaxation = [&](const std::string& file) {
    const ProgramRun shown = run_program({"finger", "show", file, "--json"});
    EXPECT_EQ(shown.status, 0) << shown.errors;
    return json::parse(shown.output)["material"]["relaxation"];
  };
  EXPECT_EQ(relaxation(finger()).size(), 2u);
  EXPECT_EQ(relaxation(place_.path("fitted.toml")), relaxation(finger()));
}

TEST_F(FingerFitCommand, ScalesEveryLayer) {
  // The mesh has one volume; its own table is a layer like any other.
  const json shown = json::parse(run_program({"finger", "show", finger(), "--json"}).output);
  std::string volume;
  for (const json& name : shown["mesh_statistics"]["volumes"]) {
    if (name != "bone") volume = name.get<std::string>();
  }
  place_.write("curve.csv", curve_with_modulus("50.0", 0.4));
  place_.write("fingers/index.toml", place_.read("fingers/index.toml") + "\n[material." + volume +
                                         "]\nyoungs_modulus_kPa = 20.0\n");
  const ProgramRun run = fit({"--parameters", "youngs_modulus_kPa", "--json"});
  ASSERT_EQ(run.status, 0) << run.errors;
  const json fitted =
      json::parse(run_program({"finger", "show", place_.path("fitted.toml"), "--json"}).output);
  const double common = fitted["material"]["youngs_modulus_kPa"];
  const double own = fitted["material"][volume]["youngs_modulus_kPa"];
  EXPECT_NEAR(own, 50.0, 1.5);
  EXPECT_NEAR(common / own, shown["material"]["youngs_modulus_kPa"].get<double>() / 20.0, 1e-4);
}

TEST_F(FingerFitCommand, FitsOneFactorOnAllLayersAndKeepsThem) {
  const std::filesystem::path fingers = std::filesystem::path(source_folder()) / "fingers";
  for (const char* file : {"index-layered.toml", "index-layered.msh"}) {
    std::filesystem::copy(fingers / file, place_.path("fingers"));
  }
  // Measured on the same finger, a tenth stiffer in all layers: the fit's own curve says how much.
  const std::string layered = place_.path("fingers/index-layered.toml");
  const ProgramRun press =
      run_program({"press", layered, "--to-mm", "0.4", "--steps", "12", "--json"});
  std::string curve = "indentation_mm,force_N\n";
  for (const json& row : json::parse(press.output)) {
    const double noise = curve.size() % 2 == 0 ? 0.01 : -0.01;
    curve += row["indentation_mm"].dump() + "," +
             std::to_string(1.1 * (1.0 + noise) * row["normal_force_N"].get<double>()) + "\n";
  }
  place_.write("curve.csv", curve);
  const ProgramRun run =
      run_program({"finger", "fit", layered, "--data", place_.path("curve.csv"), "--out",
                   place_.path("fitted.toml"), "--parameters", "youngs_modulus_kPa", "--json"});
  ASSERT_EQ(run.status, 0) << run.errors;
  const json answer = json::parse(run.output);
  const double factor = answer["parameters"]["youngs_modulus_factor"]["value"];
  EXPECT_NEAR(factor, 1.1, 0.03);
  const auto material = [](const std::string& file) {
    return json::parse(run_program({"finger", "show", file, "--json"}).output)["material"];
  };
  json before = material(layered);
  json after = material(place_.path("fitted.toml"));
  for (const char* layer : {"epidermis", "dermis", "subcutaneous"}) {
    const double was = before[layer]["youngs_modulus_kPa"];
    const double is = after[layer]["youngs_modulus_kPa"];
    EXPECT_NEAR(is / was, factor, 1e-4) << layer;
    EXPECT_NEAR(answer["moduli_kPa"]["material." + std::string(layer) + ".youngs_modulus_kPa"], is,
                1e-3);
    before[layer].erase("youngs_modulus_kPa");
    after[layer].erase("youngs_modulus_kPa");
  }
  EXPECT_EQ(before, after);
  EXPECT_THAT(place_.read("fitted.toml"), HasSubstr("one factor on all layers"));
}

TEST_F(FingerFitCommand, NamesWhatIsWrongWithTheData) {
  const std::string header = "indentation_mm,force_N\n";
  const std::string good = "0.1,0.01\n0.2,0.04\n0.3,0.08\n0.4,0.12\n0.5,0.18\n";
  expect_refused("", {"curve.csv", "empty", "indentation_mm,force_N"});
  expect_refused("indentation_m,force_N\n" + good,
                 {"curve.csv:1:", "'indentation_m'", "another unit", "indentation_mm,force_N"});
  expect_refused("indentation_mm,force_mN\n" + good, {"curve.csv:1:", "'force_mN'", "force_N"});
  expect_refused("depth,force_N\n" + good, {"curve.csv:1:", "'depth'", "indentation_mm"});
  expect_refused("indentation_mm,force_N,area_mm2\n", {"curve.csv:1:", "3 columns"});
  expect_refused(header + "0.1,0.01\n0.2,0.04\n", {"curve.csv:3:", "too few points"});
  expect_refused(header + good + "0.6,-0.2\n", {"curve.csv:7:", "force_N", "negative"});
  expect_refused(header + "-0.1,0.0\n" + good, {"curve.csv:2:", "indentation_mm", "negative"});
  expect_refused(header + good + "0.5,0.2\n", {"curve.csv:7:", "depths rising"});
  expect_refused(header + good + "0.6,much\n", {"curve.csv:7:", "'much'", "not a number"});
  expect_refused(header + good + "0.6,nan\n", {"curve.csv:7:", "not a number"});
  expect_refused(header + good + "0.6\n", {"curve.csv:7:", "1 columns"});
  expect_refused(header + good + "60,0.3\n", {"curve.csv:7:", "60", "tissue under the bone"});
  expect_refused(header + "0,0.5\n" + good, {"curve.csv:2:", "depth 0", "first touch"});
  expect_refused(header + "0.1,9\n0.2,7\n0.3,3\n0.4,1\n0.5,0.1\n",
                 {"curve.csv:", "no constants of this finger reach the curve", "%"},
                 {"--parameters", "youngs_modulus_kPa"});
  expect_refused(header + good, {"curve.csv: min:", "do not tell it", "press deeper"},
                 {"--parameters", "min"});
  expect_refused(header + good, {"--parameters stiffness", "youngs_modulus_kPa"},
                 {"--parameters", "stiffness"});
  place_.write("area.csv", "force_N,area_cm2\n0.1,0.2\n");
  expect_refused(header + good, {"area.csv:1:", "area_cm2", "area_mm2"},
                 {"--area", place_.path("area.csv")});
  place_.write("area.csv", "force_N,area_mm2\n0.1,20\n0.15,24\n5,90\n");
  expect_refused(header + good, {"area.csv:4:", "beyond"}, {"--area", place_.path("area.csv")});
  expect_refused(header + good, {"nowhere.csv", "no such file"},
                 {"--area", place_.path("nowhere.csv")});
}

}  // namespace
}  // namespace softfinger
