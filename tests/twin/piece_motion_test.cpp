#include "softfinger/twin/piece_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"

namespace softfinger {
namespace {

/// Each coordinate moved by another length in the metric of its axis, m.
Configuration moved_apart(const Device& device) {
  Configuration q = device.home();
  for (int k = 0; k < device.degrees_of_freedom(); ++k) {
    q[k] += 0.1 * mm * (k + 1) / device.axes()[static_cast<std::size_t>(k)].metric;
  }
  return q;
}

TEST(PieceMotions, OfOnePieceAllCoordinatesMoveItTogether) {
  for (const char* name : {"thimble-3rrs", "plate-6dof", "delta-schorr"}) {
    const auto device = load_device(source_folder() + "/devices/" + name + ".toml");
    ASSERT_EQ(device->solid_piece_count(), 1) << name;
    const Configuration q = moved_apart(*device);
    EXPECT_EQ(PieceMotions(*device).longest(device->home(), q),
              std::sqrt(device->squared_distance(q, device->home())))
        << name;
  }
}

TEST(PieceMotions, OfPinsTheOneThatRisesMostSaysHowFar) {
  for (const char* name : {"pins-wagner-6x6", "pins-sarakoglou-4x4"}) {
    const auto device = load_device(source_folder() + "/devices/" + name + ".toml");
    const Configuration q = moved_apart(*device);
    EXPECT_NEAR(PieceMotions(*device).longest(device->home(), q),
                0.1 * mm * device->degrees_of_freedom(), 1e-12)
        << name;
  }
}

}  // namespace
}  // namespace softfinger
