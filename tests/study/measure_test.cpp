// Many numbers as one, what a measure needs, and formulas.
#include "softfinger/study/measure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/study/expression.hpp"

namespace softfinger {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Measure, ManyNumbersBecomeOne) {
  std::vector<double> values;
  for (int k = 0; k <= 100; ++k) values.push_back(k == 50 ? 0.0 : k == 0 ? 50.0 : k);
  EXPECT_DOUBLE_EQ(over(values, Over::kMean, false), 50.0);
  EXPECT_DOUBLE_EQ(over(values, Over::kP95, false), 95.0);
  EXPECT_DOUBLE_EQ(over(values, Over::kP95, true), 5.0) << "more is better: 95 of 100 have more";
  EXPECT_DOUBLE_EQ(over(values, Over::kWorst, false), 100.0);
  EXPECT_DOUBLE_EQ(over(values, Over::kWorst, true), 0.0);
  EXPECT_DOUBLE_EQ(over({1.0, 2.0}, Over::kP95, false), 1.95) << "by a straight line";
  EXPECT_DOUBLE_EQ(over({3.0}, Over::kP95, false), 3.0);
  EXPECT_TRUE(std::isnan(over({}, Over::kMean, false)));
}

TEST(Measure, NeedsNoMoreThanItAsksFor) {
  using Depth = SkinComparison::Depth;
  EXPECT_EQ(sides_for({"normal_force_error", "iou"}).depth, Depth::kContact);
  EXPECT_EQ(sides_for({"lagged.pressure_error", "iou"}).depth, Depth::kSkin);
  EXPECT_EQ(sides_for({"stress_error", "pressure_error"}).depth, Depth::kTissue);
  EXPECT_EQ(sides_for({"strain_energy_density_error"}).depth, Depth::kTissue);
  EXPECT_FALSE(sides_for({"normal_force_error"}).lagged);
  EXPECT_EQ(sides_for({"iou", "loaded.stress_error"}).depth, Depth::kTissue);
  EXPECT_TRUE(sides_for({"loaded.stress_error"}).loaded);
  EXPECT_FALSE(sides_for({"loaded.stress_error"}).lagged);
  EXPECT_TRUE(sides_for({"lagged.iou"}).lagged);
  EXPECT_TRUE(sides_for({"motor_torque_N_mm"}).loaded);
  EXPECT_TRUE(sides_for({"frames_not_held"}).loaded);
}

TEST(Measure, OfFramesLeavesOutThoseWithoutIt) {
  Evaluation evaluation;
  evaluation.linear_motors = {false};
  evaluation.frames.resize(3);
  evaluation.frames[1].commanded.centroid_shift = 2e-3;
  evaluation.frames[2].loaded.emplace().iou = 0.5;
  evaluation.frames[2].motor_torque = 0.04;
  EXPECT_THAT(measured(evaluation, "centroid_shift_mm"), ElementsAre(2.0));
  EXPECT_THAT(measured(evaluation, "loaded.iou"), ElementsAre(0.5));
  EXPECT_THAT(measured(evaluation, "lagged.iou"), IsEmpty());
  EXPECT_THAT(measured(evaluation, "motor_torque_N_mm"), ElementsAre(40.0));
  EXPECT_THAT(measured(evaluation, "motor_force_N"), IsEmpty()) << "its motors turn";
  EXPECT_THAT(measured(evaluation, "frames_missed"), ElementsAre(0.0));
  for (const std::string& word : measure_words()) {
    EXPECT_LE(measured(evaluation, word).size(), 3u) << word;
  }
}

Expression formula(const std::string& text) {
  return {text, [](std::string_view name) -> std::optional<Expression::Meaning> {
            if (name == "device.x.0") return Expression::Meaning{.variable = 0};
            if (name == "device.x") return Expression::Meaning{.constant = 7.0};
            return {};
          }};
}

TEST(Formula, HasNamesNumbersAndFunctions) {
  EXPECT_DOUBLE_EQ(formula("2 * device.x.0 ^ 2 + device.x").value({3.0}), 25.0);
  EXPECT_DOUBLE_EQ(formula("sin(pi / 2) + sqrt(4) + max(1, device.x.0)").value({5.0}), 8.0);
  EXPECT_DOUBLE_EQ(formula("device.x.0 > 1 ? 10 : 1.5e1").value({0.0}), 15.0);
  EXPECT_TRUE(std::isnan(formula("sqrt(device.x.0)").value({-1.0})));
  EXPECT_TRUE(std::isnan(formula("1 / device.x.0").value({0.0})));
  for (const char* wrong :
       {"", "2 *", "(1", "1)", "2 device.x", "sin()", "foo(1)", "\"a\"", "1 + $"}) {
    EXPECT_THROW(formula(wrong), InputError) << wrong;
  }
  try {
    formula("2 * device.y");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("there is no number device.y"));
  }
}

}  // namespace
}  // namespace softfinger
