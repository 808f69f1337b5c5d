// What relaxation takes from the force of a press.

#include "softfinger/wearer/stiffness_in_use.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {
namespace {

const std::filesystem::path kUseProject = source_folder();

TEST(StiffnessInUse, OfGrowingForceIsTheLaplaceTransformOfRelaxation) {
  const Relaxation relaxation{{{0.3, 0.004}, {0.2, 0.07}, {0.1, 1.4}}};
  constexpr double kRate = 2.1;
  constexpr double kStep = 1e-4;  // s
  double sum = 0.0;
  for (double time = 0.5 * kStep; time < 12.0; time += kStep) {
    double left = 1.0;
    for (const Relaxation::Term& term : relaxation.terms) {
      left -= term.fraction * (1.0 - std::exp(-time / term.time));
    }
    sum += kRate * kStep * left * std::exp(-kRate * time);
  }
  EXPECT_NEAR(stress_of_growing_force(relaxation, kRate), sum, 1e-4);
  EXPECT_EQ(stress_of_growing_force({}, kRate), 1.0);
}

TEST(StiffnessInUse, APressIsThatMuchSofter) {
  const auto relaxing = FingerModel::load(kUseProject / "fingers" / "index-viscoelastic.toml");
  auto lasting = std::make_shared<FingerModel>(*relaxing);
  lasting->relaxation.terms.clear();
  const auto device = load_device(kUseProject / "devices" / "thimble-3rrs.toml");
  constexpr double kSpeed = 1e-3;          // m/s
  constexpr double kElapsed = 1.0 / 30.0;  // s
  Twin with(relaxing, device);
  Twin without(lasting, device);
  Configuration q = device->home();
  for (int tick = 0; tick < 118; ++tick) {
    device->advance(kSpeed * kElapsed, q);
    with.press(q, 0.0, kElapsed);
    without.press(q, 0.0, kElapsed);
  }
  ASSERT_GT(without.contact().normal_force, 0.4);
  const double softer = with.contact().normal_force / without.contact().normal_force;
  EXPECT_NEAR(softer * stiffness_in_use(*relaxing, kSpeed), 1.0, 0.06);
  EXPECT_LT(softer, 0.6);
}

TEST(StiffnessInUse, IsThatOfThePressWhereNothingRelaxes) {
  const auto finger = FingerModel::load(kUseProject / "fingers" / "index.toml");
  EXPECT_EQ(stiffness_in_use(*finger, 1e-3), 1.0);
}

}  // namespace
}  // namespace softfinger
