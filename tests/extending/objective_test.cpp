// The worked example of docs/extending.md: an objective of one's own.
#include <gtest/gtest.h>

#include "objective/level.hpp"
#include "objectives/pressed_finger.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

TEST(LevelObjective, TravelsWithTheContactAndNeverTurns) {
  const PressedFinger pressed(1.0 * mm);
  const auto device = device_of("thimble-3rrs");
  const int travel = device->approach_axis();
  ASSERT_GE(travel, 0);
  const auto level = level_objective().make(pressed.model, device);
  const auto surface = objective_kind("surface")->make(pressed.model, device);
  for (int tick = 0; tick < 30; ++tick) {
    const RenderedSurface& turned = surface->tick(pressed.finger(), 1.0 / 30.0);
    const RenderedSurface& rendered = level->tick(pressed.finger(), 1.0 / 30.0);
    EXPECT_TRUE(device->reachable(rendered.configuration));
    EXPECT_DOUBLE_EQ(rendered.configuration[travel], turned.configuration[travel]);
    for (int axis = 0; axis < device->degrees_of_freedom(); ++axis) {
      if (axis == travel) continue;
      EXPECT_EQ(rendered.configuration[axis], device->home()[axis]);
    }
  }
  EXPECT_GT(level->tick(pressed.finger(), 1.0 / 30.0).configuration[travel],
            device->home()[travel] + 1.0 * mm);
}

}  // namespace
}  // namespace softfinger
