// A finger without coupling and without objects: what mechanics conserves.

#include <gtest/gtest.h>

#include "../support/free_flight.hpp"

namespace softfinger {
namespace {

using testing_support::FreeFlight;

TEST(FreeFlightTest, KeepsLinearMomentum) {
  FreeFlight flight(1e-3);
  ASSERT_TRUE(flight.step());
  const Vector3 first = flight.momentum();
  for (int k = 0; k < 300; ++k) ASSERT_TRUE(flight.step());
  EXPECT_LT((flight.momentum() - first).norm(), 1e-9 * first.norm());
}

TEST(FreeFlightTest, NeverGainsEnergy) {
  for (const double time_step : {0.1e-3, 1e-3, 16e-3}) {
    FreeFlight flight(time_step);
    ASSERT_TRUE(flight.step());
    double energy = flight.energy();
    for (int k = 0; k < 200; ++k) {
      ASSERT_TRUE(flight.step());
      const double now = flight.energy();
      EXPECT_LE(now, energy * (1.0 + 1e-10)) << "time step " << time_step << ", step " << k;
      energy = now;
    }
  }
}

}  // namespace
}  // namespace softfinger
