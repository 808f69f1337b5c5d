#include <gtest/gtest.h>

#include "thimble.hpp"

namespace softfinger {
namespace {

TEST(ThimbleSizing, TiltsAndTravels) {
  const WorkspaceSummary workspace = thimble().workspace_summary();
  EXPECT_GE(workspace.min_tilt_at_mid_travel, 25.0 * deg);
  EXPECT_GE(workspace.max_travel - workspace.min_travel, 5.0 * mm);
  EXPECT_NEAR(workspace.max_tilt, thimble_legs().geometry().max_tilt, 1e-6);
  EXPECT_NEAR(workspace.mid_travel, 0.5 * (workspace.min_travel + workspace.max_travel), 1e-12);
}

// What docs and device file claim, on a grid that the summary does not use.
TEST(ThimbleSizing, TiltsThirtyDegreesEverywhereFromHomeToDeepPress) {
  for (double travel = 0.0; travel <= 7.0; travel += 0.25) {
    for (int direction = 0; direction < 360; direction += 3) {
      const double azimuth = direction * deg;
      EXPECT_TRUE(thimble().reachable(
          configuration(29.99 * std::cos(azimuth), 29.99 * std::sin(azimuth), travel)))
          << travel << " " << direction;
    }
  }
}

TEST(ThimbleSizing, NoSingularityNear) {
  const WorkspaceSummary workspace = thimble().workspace_summary();
  const double margin = thimble_legs().geometry().max_tilt + 5.0 * deg;
  int within = 0;
  // Wherever the joints are within their limits, and in all directions at mid travel.
  for (double travel = workspace.min_travel; travel <= workspace.max_travel; travel += 0.25 * mm) {
    for (int direction = 0; direction < 360; direction += 5) {
      for (double tilt = 0.0; tilt <= margin; tilt += 1.0 * deg) {
        Configuration q(3);
        q << tilt * std::cos(direction * deg), tilt * std::sin(direction * deg), travel;
        JointAngles joints;
        if (!thimble().inverse_kinematics(q, joints)) continue;
        if ((joints - thimble().joint_limits().min).minCoeff() < 0.0) continue;
        if ((joints - thimble().joint_limits().max).maxCoeff() > 0.0) continue;
        EXPECT_GT(thimble_legs().singularity_ratio(q), 0.3);
        ++within;
      }
    }
  }
  EXPECT_GT(within, 10000);
}

TEST(ThimbleSizing, RetractsAwayFromTheFinger) {
  EXPECT_TRUE(thimble().reachable(thimble().retracted()));
  EXPECT_LT(thimble().retracted()[2], thimble().home()[2]);
}

}  // namespace
}  // namespace softfinger
