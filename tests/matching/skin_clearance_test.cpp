#include "softfinger/matching/skin_clearance.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "../support/folders.hpp"
#include "pad.hpp"

namespace softfinger {
namespace {

class Clearance : public testing::TestWithParam<std::string> {};

// Wherever the device is, in the flesh and beyond it too, it keeps the gap from outside: no further
// advanced than where it comes that near from home.
TEST_P(Clearance, IsKeptFromOutside) {
  const auto device = load_device(source_folder() + "/devices/" + GetParam() + ".toml");
  const int axis = device->approach_axis();
  ASSERT_GE(axis, 0);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> even(0.0, 1.0);
  const Pad pad = resting_pad(200, random);
  ContactSet contact;
  contact.samples.resize(pad.points.size());
  for (std::size_t i = 0; i < pad.points.size(); ++i) {
    contact.samples[i].position_F = pad.points[i];
  }
  SkinClearance skin(*device, pad.size());
  skin.take(contact);
  for (int trial = 0; trial < 50; ++trial) {
    Configuration from = device->home();
    for (int k = 0; k < from.size(); ++k) {
      if (k == axis) continue;
      const bool turns = device->axes()[static_cast<std::size_t>(k)].angular;
      from[k] += (even(random) - 0.5) * (turns ? 20.0 * deg : 4.0 * mm);
    }
    const double wanted = 2.0 * mm * even(random);
    const Configuration outside = skin.with_gap(from, wanted);
    ASSERT_NEAR(skin.gap(outside), wanted, 1e-8);
    device->advance(15.0 * mm * even(random), from);
    const Configuration kept = skin.with_gap(from, wanted);
    EXPECT_NEAR(skin.gap(kept), wanted, 1e-8) << trial;
    EXPECT_LT(device->squared_distance(kept, outside), 1e-8 * 1e-8) << trial;
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, Clearance,
                         testing::Values("delta-schorr", "roller-provancher", "thimble-3rrs",
                                         "plate-2dof", "plate-6dof", "five-bar",
                                         "shear-tactor-gleeson", "strap-minamizawa",
                                         "slip-ball-webster", "slip-wheel-salada",
                                         "lateral-pins-pasquero"),
                         [](const auto& device) {
                           std::string name = device.param;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

}  // namespace
}  // namespace softfinger
