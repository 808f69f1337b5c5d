// What tells soft from hard: how the area of contact grows with the force.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "softfinger/twin/area_spread.hpp"

namespace softfinger {
namespace {

struct Moment {
  double force, area;
};
double rate_of(const std::vector<Moment>& moments) {
  AreaSpread spread;
  for (const Moment& moment : moments) spread.add(moment.force, moment.area);
  return spread.rate();
}

TEST(AreaSpread, IsTheSlopeOfALineWhereverThatLies) {
  for (const double offset : {0.0, 3e-5, 1.0}) {
    std::vector<Moment> line;
    for (int k = 0; k < 50; ++k) {
      const double force = 0.5 + 0.5 * std::sin(0.7 * k);
      line.push_back({force, offset + 4e-5 * force});
    }
    EXPECT_NEAR(rate_of(line), 4e-5, 1e-15 + 1e-14 * offset);
  }
}

TEST(AreaSpread, IsTheLeastSquaresSlope) {
  // By hand: forces 0, 1, 2 about 1, areas 1, 2, 6 about 3: (2 + 3) / 2.
  EXPECT_DOUBLE_EQ(rate_of({{0.0, 1.0}, {1.0, 2.0}, {2.0, 6.0}}), 2.5);
  EXPECT_DOUBLE_EQ(rate_of({{2.0, 6.0}, {0.0, 1.0}, {1.0, 2.0}}), 2.5);
}

TEST(AreaSpread, OfHertzsBallIsThatOfItsLaw) {
  // a^2 = (3 F R / 4 E)^(2/3), between 0.9 and 1.1 N, hardly bent: dA/dF = 2/3 A/F.
  std::vector<Moment> ball;
  const auto area = [](double force) {
    return std::numbers::pi * std::pow(0.75 * force * 8e-3 / 30e3, 2.0 / 3.0);
  };
  for (int k = 0; k <= 200; ++k) ball.push_back({0.9 + 1e-3 * k, area(0.9 + 1e-3 * k)});
  const double wanted = 2.0 / 3.0 * area(1.0);
  EXPECT_NEAR(rate_of(ball), wanted, 2e-3 * wanted);
}

TEST(AreaSpread, NeedsAForceThatVaries) {
  EXPECT_TRUE(std::isnan(rate_of({})));
  EXPECT_TRUE(std::isnan(rate_of({{0.5, 1e-5}})));
  EXPECT_TRUE(std::isnan(rate_of({{0.50, 1e-5}, {0.59, 2e-5}})));
  EXPECT_FALSE(std::isnan(rate_of({{0.50, 1e-5}, {0.61, 2e-5}})));
}

}  // namespace
}  // namespace softfinger
