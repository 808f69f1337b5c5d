#include <gtest/gtest.h>

#include "softfinger/base/units.hpp"
#include "softfinger/motors/servo_map.hpp"

namespace softfinger {
namespace {

/// One step is one unit, ten a radian.
const ServoSettings kWhole{
    .channel = 0, .zero = 100.0, .per_radian = 10.0, .min = 50.0, .max = 150.0, .step = 1.0};

TEST(ServoMapEdges, TakesTheNearestStep) {
  const ServoMap map(kWhole);
  EXPECT_EQ(map.target(0.04, -1.0, 1.0), 100);
  EXPECT_EQ(map.target(0.06, -1.0, 1.0), 101);
  EXPECT_EQ(map.target(-0.06, -1.0, 1.0), 99);
}

TEST(ServoMapEdges, RoundsInwardsAtLimits) {
  const ServoMap map(kWhole);
  EXPECT_EQ(map.target(9.0, -0.96, 0.97), 109);
  EXPECT_EQ(map.target(-9.0, -0.96, 0.97), 91);
  ServoSettings reversed = kWhole;
  reversed.per_radian = -10.0;
  EXPECT_EQ(ServoMap(reversed).target(9.0, -0.96, 0.97), 91);
  EXPECT_EQ(ServoMap(reversed).target(-9.0, -0.96, 0.97), 109);
}

TEST(ServoMapEdges, ALimitThatIsAWholeStepButForItsLastBitIsThatStep) {
  const ServoMap map(kWhole);
  EXPECT_EQ(map.target(9.0, -1.0 + 1e-9, 1.0 - 1e-9), 110);
  EXPECT_EQ(map.target(-9.0, -1.0 + 1e-9, 1.0 - 1e-9), 90);
  EXPECT_EQ(map.target(9.0, -1.0, 1.0 - 1e-5), 109) << "more than rounding";
  EXPECT_EQ(map.target(-9.0, -1.0 + 1e-5, 1.0), 91);
}

// Limits closer than a step have none between them: the one below, on any side.
TEST(ServoMapEdges, BetweenLimitsWithoutAStepItTakesTheOneBelow) {
  const ServoMap map(kWhole);
  for (const double joint : {-9.0, 0.05, 9.0}) EXPECT_EQ(map.target(joint, 0.02, 0.08), 100);
}

TEST(ServoMapEdges, TheCutHoldsWhateverTheLimits) {
  const ServoMap map(kWhole);
  EXPECT_EQ(map.target(99.0, -100.0, 100.0), 150);
  EXPECT_EQ(map.target(-99.0, -100.0, 100.0), 50);
  EXPECT_NEAR(map.resolution(), 0.1, 1e-15);
  EXPECT_NEAR(map.joint(200.0), 10.0, 1e-12) << "as it is";
}

}  // namespace
}  // namespace softfinger
