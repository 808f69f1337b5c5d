#include "softfinger/fem/strain_limit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "softfinger/fem/double_arithmetic.hpp"

namespace softfinger {
namespace {

constexpr StrainLimit kLimits{0.35, 1.5, 40e3, 0.5};

StrainLimitResponse<double> at(double stretch) { return strain_limit_at(kLimits, stretch); }

TEST(StrainLimit, IsSilentInsideAndGrowsBeyond) {
  EXPECT_EQ(at(1.0).energy, 0.0);
  EXPECT_EQ(at(0.86).second, 0.0);
  EXPECT_GT(at(0.6).energy, 0.0);
  EXPECT_LT(at(0.6).first, 0.0);
  EXPECT_GT(at(1.4).first, 0.0);
}

TEST(StrainLimit, FollowsItsFormula) {
  // k w^2 t^3 / (1 - t) with t = (1.3 - (1.5 - 0.5)) / 0.5 = 0.6
  EXPECT_NEAR(at(1.3).energy, 40e3 * 0.25 * 0.216 / 0.4, 1e-9);
  const double t = 0.35 + 0.5 - 0.7;
  EXPECT_NEAR(at(0.7).energy, 40e3 * 0.25 * std::pow(t / 0.5, 3) / (1.0 - t / 0.5), 1e-9);
}

TEST(StrainLimit, DerivativesAreThoseOfTheEnergy) {
  for (double s = -0.5; s < 3.0; s += 0.0371) {
    const double h = 1e-6;
    const auto low = at(s - h);
    const auto high = at(s + h);
    const auto here = at(s);
    EXPECT_NEAR((high.energy - low.energy) / (2 * h), here.first,
                1e-4 * (1.0 + std::abs(here.first)));
    EXPECT_NEAR((high.first - low.first) / (2 * h), here.second,
                1e-4 * (1.0 + std::abs(here.second)));
  }
}

TEST(StrainLimit, IsTwiceContinuousWhereItChangesForm) {
  for (double t : {0.0, 0.95}) {
    const auto before = strain_limit_onset<DoubleArithmetic>(t - 1e-9);
    const auto after = strain_limit_onset<DoubleArithmetic>(t + 1e-9);
    EXPECT_NEAR(before.energy, after.energy, 1e-5);
    EXPECT_NEAR(before.first, after.first, 1e-4);
    EXPECT_NEAR(before.second, after.second, 0.02);
  }
}

}  // namespace
}  // namespace softfinger
