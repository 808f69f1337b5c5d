// Constants of a finger estimated from presses that were simulated with known ones.

#include "softfinger/identification/finger_fit.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <random>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/identification/indentation.hpp"

namespace softfinger {
namespace {

constexpr double kDepth = 2e-3;
constexpr double kTrueFactor = 1.3;
constexpr double kTrueMin = 0.42;
constexpr double kTrueMax = 1.36;

/// The finger for real time, its constants fixed here: limits whose width leaves room on both
/// sides.
std::shared_ptr<const FingerModel> default_finger() {
  static const auto model = [] {
    auto copy = std::make_shared<FingerModel>(
        *FingerModel::load(std::filesystem::path(source_folder()) / "fingers" / "index.toml"));
    for (FingerModel::Material& material : copy->materials) {
      material.youngs_modulus = 25e3;
      material.poissons_ratio = 0.4;
    }
    copy->strain_limits = {0.38, 1.42, 80e3, 0.3};
    return copy;
  }();
  return model;
}

const FingerConstants kTruth{kTrueFactor, kTrueMin, kTrueMax};

/// Depths and forces as a test bench would see them: `noise` relative or, in N, absolute.
MeasuredColumns measured(const PressCurve& curve, int rows, double noise, ForceNoise kind,
                         unsigned seed, double offset = 0.0) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  MeasuredColumns columns;
  columns.file = "synthetic.csv";
  for (int k = 1; k <= rows; ++k) {
    const double depth = curve.deepest() * (k - offset) / rows;
    const double force = curve.force(depth);
    const double error = noise * normal(generator) * (kind == ForceNoise::kRelative ? force : 1.0);
    columns.first.push_back(depth);
    columns.second.push_back(std::max(force + error, 0.0));
    columns.lines.push_back(k + 1);
  }
  return columns;
}

FitInput input_of(MeasuredColumns curve) {
  FitInput input;
  input.curve = std::move(curve);
  input.start = {1.0, default_finger()->strain_limits.min, default_finger()->strain_limits.max};
  input.width = default_finger()->strain_limits.width;
  input.has_limits = true;
  return input;
}

std::optional<PressCurve> press(const FingerConstants& constants, double depth = kDepth) {
  return simulate_press(with_constants(*default_finger(), constants), depth, 0.0);
}

const FingerFit::Estimate& estimate_of(const FingerFit& fit, FitParameter parameter) {
  for (const FingerFit::Estimate& e : fit.estimates) {
    if (e.parameter == parameter) return e;
  }
  throw std::out_of_range("not estimated: " + name_of(parameter));
}

/// Hundreds of presses: in optimised builds only.
class FingerFitTest : public testing::Test {
 protected:
  void SetUp() override {
#ifndef NDEBUG
    GTEST_SKIP() << "takes minutes without optimisation";
#endif
  }
};

TEST_F(FingerFitTest, RecoversKnownConstantsFromNoisyData) {
  const PressCurve truth = *press(kTruth);
  const FitInput input = input_of(measured(truth, 40, 0.02, ForceNoise::kRelative, 3));
  const FingerFit fit = fit_finger(input, [](const FingerConstants& c) { return press(c); });
  EXPECT_EQ(fit.noise, ForceNoise::kRelative);
  EXPECT_NEAR(fit.force_noise, 0.02, 0.006);
  ASSERT_EQ(fit.estimates.size(), 3u);
  EXPECT_NEAR(estimate_of(fit, FitParameter::kYoungsModulus).value, kTrueFactor, 0.03);
  EXPECT_NEAR(estimate_of(fit, FitParameter::kMin).value, kTrueMin, 0.01);
  EXPECT_NEAR(estimate_of(fit, FitParameter::kMax).value, kTrueMax, 0.03);
  for (const FingerFit::Estimate& e : fit.estimates) {
    EXPECT_LT(e.ci95_low, e.value);
    EXPECT_GT(e.ci95_high, e.value);
  }
  // Points that the fit has not seen, between its own: within what the noise alone does to them.
  const PressCurve predicted = *press(fit.constants);
  const MeasuredColumns held_out = measured(truth, 40, 0.02, ForceNoise::kRelative, 4, 0.5);
  double squares = 0.0;
  for (std::size_t k = 4; k < held_out.first.size(); ++k) {
    squares += std::pow(held_out.second[k] / predicted.force(held_out.first[k]) - 1.0, 2);
  }
  EXPECT_LT(std::sqrt(squares / 36.0), 0.03);
}

TEST_F(FingerFitTest, TellsAbsoluteNoiseFromRelative) {
  const double depth = 1e-3;
  const auto simulate = [&](const FingerConstants& c) { return press(c, depth); };
  FitInput input = input_of(measured(*press(kTruth, depth), 30, 0.01, ForceNoise::kAbsolute, 5));
  input.start = kTruth;
  input.parameters = {FitParameter::kYoungsModulus};
  const FingerFit fit = fit_finger(input, simulate);
  EXPECT_EQ(fit.noise, ForceNoise::kAbsolute);
  EXPECT_NEAR(fit.force_noise, 0.01, 0.004);
  EXPECT_NEAR(fit.estimates[0].value, kTrueFactor, 0.05);
}

TEST_F(FingerFitTest, AShallowCurveGivesTheModulusAlone) {
  const double depth = 0.5e-3;
  const auto simulate = [&](const FingerConstants& c) { return press(c, depth); };
  FitInput input = input_of(
      measured(*press({kTrueFactor, 0.38, 1.42}, depth), 20, 0.03, ForceNoise::kRelative, 6));
  const FingerFit fit = fit_finger(input, simulate);
  ASSERT_EQ(fit.estimates.size(), 1u);
  EXPECT_NEAR(fit.estimates[0].value, kTrueFactor, 0.05);
  ASSERT_EQ(fit.kept.size(), 2u);
  EXPECT_EQ(fit.constants.min, 0.38);
  EXPECT_EQ(fit.constants.max, 1.42);
  for (const FingerFit::Kept& kept : fit.kept) {
    EXPECT_NE(kept.reason.find("press deeper"), std::string::npos) << kept.reason;
  }
  // Asked for by name, the limit is refused and not fixed in silence.
  input.parameters = {FitParameter::kYoungsModulus, FitParameter::kMin};
  try {
    (void)fit_finger(input, simulate);
    FAIL() << "not refused";
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("synthetic.csv: min: the data do not tell it"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(FingerFitTest, SaysHowFarOffTheBestIs) {
  // Force that falls while the depth rises: no finger does that.
  const double depth = 1e-3;
  MeasuredColumns curve = measured(*press(kTruth, depth), 40, 0.0, ForceNoise::kRelative, 1);
  for (std::size_t k = 0; k < curve.second.size(); ++k) {
    curve.second[k] = 0.05 + 0.5 * std::exp(-static_cast<double>(k) / 8.0);
  }
  try {
    (void)fit_finger(input_of(curve), [&](const FingerConstants& c) { return press(c, depth); });
    FAIL() << "not refused";
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("synthetic.csv:"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("no constants of this finger reach the curve"),
              std::string::npos)
        << error.what();
  }
}

/// The press as its second-order expansion in the constants, about the true ones: ln F = f + g . p
/// + 1/2 p . H p at each depth. A hundred fits cost nothing with it.
class PressExpansion {
 public:
  PressExpansion() {
    const PressCurve centre = *press(kTruth);
    spacing_ = kDepth / kRows;
    const auto logs = [&](const std::array<double, 3>& p) {
      const PressCurve curve = *press(at(p));
      Eigen::VectorXd f(kRows);
      for (int k = 0; k < kRows; ++k) f[k] = std::log(curve.force(spacing_ * (k + 1)));
      return f;
    };
    value_ = logs({0, 0, 0});
    for (std::size_t i = 0; i < 3; ++i) {
      std::array<double, 3> up{}, down{};
      up[i] = kStep[i];
      down[i] = -kStep[i];
      const Eigen::VectorXd above = logs(up), below = logs(down);
      first_[i] = (above - below) / (2.0 * kStep[i]);
      second_[i][i] = (above - 2.0 * value_ + below) / (kStep[i] * kStep[i]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        std::array<double, 3> both{};
        both[i] = kStep[i];
        both[j] = kStep[j];
        const Eigen::VectorXd own =
            value_ + first_[i] * kStep[i] + first_[j] * kStep[j] +
            0.5 * (second_[i][i] * kStep[i] * kStep[i] + second_[j][j] * kStep[j] * kStep[j]);
        second_[i][j] = second_[j][i] = (logs(both) - own) / (kStep[i] * kStep[j]);
      }
    }
  }

  [[nodiscard]] static FingerConstants at(const std::array<double, 3>& p) {
    return {kTrueFactor * std::exp(p[0]), kTrueMin + p[1], kTrueMax + p[2]};
  }
  [[nodiscard]] PressCurve curve(const FingerConstants& c) const {
    const std::array<double, 3> p{std::log(c.youngs_modulus_factor / kTrueFactor), c.min - kTrueMin,
                                  c.max - kTrueMax};
    Eigen::VectorXd f = value_;
    for (std::size_t i = 0; i < 3; ++i) {
      f += first_[i] * p[i];
      for (std::size_t j = 0; j < 3; ++j) f += 0.5 * second_[i][j] * p[i] * p[j];
    }
    std::vector<double> forces;
    for (int k = 0; k < kRows; ++k) forces.push_back(std::exp(f[k]));
    return {spacing_, forces, std::vector<double>(kRows, 0.0)};
  }

 private:
  static constexpr int kRows = 40;
  static constexpr std::array<double, 3> kStep{0.06, 0.015, 0.03};
  double spacing_ = 0.0;
  Eigen::VectorXd value_;
  std::array<Eigen::VectorXd, 3> first_;
  std::array<std::array<Eigen::VectorXd, 3>, 3> second_;
};

TEST_F(FingerFitTest, IntervalsCoverTheTruthAsOftenAsTheySay) {
  const PressExpansion expansion;
  // The expansion is the press wherever the trials go.
  for (const std::array<double, 3>& p :
       {std::array{0.03, -0.008, 0.02}, std::array{-0.03, 0.008, -0.015},
        std::array{0.02, 0.008, 0.01}}) {
    const PressCurve simulated = *press(PressExpansion::at(p));
    const PressCurve expanded = expansion.curve(PressExpansion::at(p));
    for (double depth = 0.2e-3; depth <= kDepth; depth += 0.2e-3) {
      EXPECT_NEAR(expanded.force(depth) / simulated.force(depth), 1.0, 0.01) << depth / mm;
    }
  }
  constexpr int kTrials = 100;
  std::array<int, 3> covered{};
  for (int trial = 0; trial < kTrials; ++trial) {
    FitInput input = input_of(measured(expansion.curve(kTruth), 40, 0.02, ForceNoise::kRelative,
                                       static_cast<unsigned>(1000 + trial)));
    input.parameters = {FitParameter::kYoungsModulus, FitParameter::kMin, FitParameter::kMax};
    const FingerFit fit =
        fit_finger(input, [&](const FingerConstants& c) { return expansion.curve(c); });
    const std::array truth{kTrueFactor, kTrueMin, kTrueMax};
    for (std::size_t i = 0; i < 3; ++i) {
      const FingerFit::Estimate& e = fit.estimates[i];
      covered[i] += e.ci95_low <= truth[i] && truth[i] <= e.ci95_high ? 1 : 0;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GE(covered[i], 90) << i;
    EXPECT_LE(covered[i], 99) << i;
    RecordProperty("covered_" + std::to_string(i), covered[i]);
  }
}

TEST_F(FingerFitTest, ContactAreasJoinIn) {
  const PressCurve truth = *press(kTruth);
  FitInput input = input_of(measured(truth, 40, 0.02, ForceNoise::kRelative, 8));
  input.areas.emplace();
  input.areas->file = "areas.csv";
  std::mt19937 generator(9);
  std::normal_distribution<double> normal(1.0, 0.05);
  for (int k = 1; k <= 15; ++k) {
    const double force = 0.1 * k * truth.greatest_force() / 1.5;
    input.areas->first.push_back(force);
    input.areas->second.push_back(truth.area(force) * normal(generator));
    input.areas->lines.push_back(k + 1);
  }
  const FingerFit fit = fit_finger(input, [](const FingerConstants& c) { return press(c); });
  EXPECT_NEAR(fit.area_noise, 0.05, 0.025);
  EXPECT_EQ(fit.degrees_of_freedom, 40 + 15 - 3);
  EXPECT_NEAR(estimate_of(fit, FitParameter::kYoungsModulus).value, kTrueFactor, 0.04);
}

}  // namespace
}  // namespace softfinger
