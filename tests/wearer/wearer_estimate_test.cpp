// What presses tell of a wearer who is as the model has wearers.

#include "softfinger/wearer/wearer_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../support/folders.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/wearer/press_plan.hpp"

namespace softfinger {
namespace {

const std::filesystem::path kEstimateProject = source_folder();

class WearerEstimateTest : public testing::Test {
 protected:
  /// Presses of the model with these traits, to 0.8 N.
  std::vector<PressRecord> presses_of(const TraitVector& x, double noise) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    model_.put(x);
    std::vector<PressRecord> presses;
    for (const PlannedPress& plan : plan_presses(*device_, *finger_, 1.5 * mm)) {
      PressRecord press{.start = plan.tilted, .readings = {}};
      ReachedForce touch;
      EXPECT_TRUE(model_.advance_for(plan.tilted, 0.05, 12.0 * mm, touch));
      for (int i = 0; i < 20; ++i) {
        Configuration q = plan.tilted;
        device_->advance(touch.advance + i * 0.05 * mm, q);
        const double force = model_.press(plan.tilted, {{q}}, false).front().force;
        press.readings.push_back({q, force + noise * normal(random), 1.0});
        if (force > 0.8) break;
      }
      presses.push_back(press);
    }
    return presses;
  }

  std::shared_ptr<const FingerModel> finger_ =
      FingerModel::load(kEstimateProject / "fingers" / "index.toml");
  std::shared_ptr<const Device> device_ =
      load_device(kEstimateProject / "devices" / "thimble-3rrs.toml");
  PressModel model_{finger_, device_, 0.0};
};

TEST_F(WearerEstimateTest, ForcesComeOutRight) {
  TraitVector x;
  x << 0.5, -0.6, 0.8, 0.4, -0.3, 0.5, -0.6, 0.5, 0.7;
  const std::vector<PressRecord> presses = presses_of(x, 0.02);
  const WearerEstimate found = estimate_wearer(model_, presses, {.noise = 0.02});
  EXPECT_LT(found.predicted_force_error, 0.06);
  EXPECT_LT(found.force_deviation, 0.03);
  // Of where it began hardly anything was right.
  model_.put(TraitVector::Zero());
  const PressRecord& level = presses.front();
  const Configuration& last = level.readings.back().q;
  const double before = model_.press(level.start, {{last}}, false).front().force;
  model_.put(found.x);
  const double after = model_.press(level.start, {{last}}, false).front().force;
  model_.put(x);
  const double truth = model_.press(level.start, {{last}}, false).front().force;
  EXPECT_GT(std::abs(before - truth), 0.3 * truth);
  EXPECT_LT(std::abs(after - truth), 0.05 * truth);
  EXPECT_TRUE(found.is_told(WearerTrait::kMountZ));
}

TEST_F(WearerEstimateTest, WhatIsFeltBesideThePadMovesLittleOfWhatIsFeltStraightOn) {
  const TraitVector x = TraitVector::Zero();
  std::vector<PressRecord> presses = presses_of(x, 0.0);
  const PressRecord level = presses.front();
  const auto forces = [&](const TraitVector& at) {
    std::vector<Configuration> path;
    for (const PressReading& reading : level.readings) path.push_back(reading.q);
    model_.put(at);
    return model_.press(level.start, path, false);
  };
  // As if the flanks of this finger were unlike the model's, each otherwise.
  const double factors[] = {1.0, 1.25, 0.75, 1.3, 0.8, 0.7, 1.25, 0.75, 1.3};
  ASSERT_EQ(presses.size(), std::size(factors));
  for (std::size_t k = 0; k < presses.size(); ++k) {
    for (PressReading& reading : presses[k].readings) reading.force *= factors[k];
  }
  const WearerEstimate found = estimate_wearer(model_, presses, {.noise = 0.02});
  const double before = forces(x).back().force;
  ASSERT_GT(before, 0.5);
  EXPECT_NEAR(forces(found.x).back().force, before, 0.05 * before);
}

TEST_F(WearerEstimateTest, AWearerWhoMovedBetweenPressesIsNotBelieved) {
  std::vector<PressRecord> presses = presses_of(TraitVector::Zero(), 0.0);
  for (std::size_t k = 0; k < presses.size(); ++k) {
    for (PressReading& reading : presses[k].readings) {
      device_->advance((k % 2 == 0 ? 0.8 : -0.8) * mm, reading.q);
    }
  }
  EXPECT_GT(estimate_wearer(model_, presses, {.noise = 0.02}).predicted_force_error, 0.2);
}

TEST_F(WearerEstimateTest, PressesThatTouchNothingAreRefused) {
  std::vector<PressRecord> presses(2, PressRecord{.start = device_->home(), .readings = {}});
  for (PressRecord& press : presses) press.readings.assign(5, {device_->home(), 0.0, 1.0});
  EXPECT_THROW((void)estimate_wearer(model_, presses, {}), OperationError);
}

}  // namespace
}  // namespace softfinger
