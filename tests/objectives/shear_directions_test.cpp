#include "softfinger/objectives/shear_directions.hpp"

#include <gtest/gtest.h>

#include <string>

#include "../support/folders.hpp"
#include "pressed_finger.hpp"
#include "softfinger/objectives/force_aware_matching.hpp"

namespace softfinger {
namespace {

std::shared_ptr<const FingerModel> index_finger() {
  static const auto model =
      FingerModel::load(std::filesystem::path(source_folder()) / "fingers" / "index.toml");
  return model;
}

TEST(ShearDirections, DevicesThatOnlyPressAndTiltHaveNone) {
  for (const char* name :
       {"thimble-3rrs", "thimble-3rrs-mechanism", "cable-prattichizzo", "plate-2dof", "membrane",
        "pins-wagner-6x6", "pins-sarakoglou-4x4", "disk-linear"}) {
    EXPECT_TRUE(shear_projection(*index_finger(), *device_of(name)).isZero(0.0)) << name;
  }
}

TEST(ShearDirections, AreThoseInWhichTheOthersMove) {
  const auto expect = [](const char* name, const Vector3& diagonal) {
    const Matrix3 projection = shear_projection(*index_finger(), *device_of(name));
    EXPECT_LT((projection * projection - projection).norm(), 1e-12) << name;
    EXPECT_LT((projection - projection.transpose()).norm(), 1e-12) << name;
    // The skin's lowest point is not where a round surface is highest.
    EXPECT_LT((projection.diagonal() - diagonal).norm(), 0.1) << name << '\n' << projection;
  };
  expect("delta-schorr", {1.0, 1.0, 0.0});
  expect("plate-6dof", {1.0, 1.0, 0.0});
  expect("shear-tactor-gleeson", {1.0, 1.0, 0.0});
  expect("slip-ball-webster", {1.0, 1.0, 0.0});
  expect("slip-wheel-salada", {1.0, 0.0, 0.0});
  expect("lateral-pins-pasquero", {1.0, 0.0, 0.0});
  expect("strap-minamizawa", {0.0, 1.0, 0.0});
  expect("five-bar", {1.0, 0.0, 0.0});
  expect("roller-provancher", {1.0, 0.0, 0.0});
}

/// Bits of the matches of a pressed finger whose object pulls it aside, tick by tick.
std::vector<Configuration> matches(const char* name, double tangential_weight) {
  PressedFinger held(1.0 * mm);
  const auto device = device_of(name);
  ForceAwareOptions options;
  options.tangential_weight = tangential_weight;
  ForceAwareMatching matching(held.model, device, static_cast<int>(held.contact.samples.size()),
                              options);
  SurfaceFollowing surface(device, static_cast<int>(held.contact.samples.size()));
  std::vector<Configuration> result;
  for (int tick = 0; tick < 6; ++tick) {
    held.contact.tangential_force_F = Vector3(0.1 * tick, -0.05 * tick, 0.0);
    const Configuration q = surface.tick(held.contact, kTick).configuration;
    result.push_back(matching.match(held.contact, q, 0.5, kTick, {}).configuration);
  }
  return result;
}

// Not by little: what such a device was asked for before it still is, to the bit.
TEST(ShearDirections, WhatCannotShearDoesNotTry) {
  for (const char* name : {"thimble-3rrs", "plate-2dof", "membrane"}) {
    const auto with = matches(name, ForceAwareOptions{}.tangential_weight);
    const auto without = matches(name, 0.0);
    for (std::size_t k = 0; k < with.size(); ++k) EXPECT_EQ(with[k], without[k]) << name << k;
  }
  const auto with = matches("delta-schorr", ForceAwareOptions{}.tangential_weight);
  const auto without = matches("delta-schorr", 0.0);
  EXPECT_NE(with.back(), without.back());
}

}  // namespace
}  // namespace softfinger
