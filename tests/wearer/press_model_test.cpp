// Forces that presses are foretold to be felt with, and their derivatives.

#include "softfinger/wearer/press_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/wearer/press_plan.hpp"

namespace softfinger {
namespace {

const std::filesystem::path kWearerProject = source_folder();

class PressModelTest : public testing::Test {
 protected:
  std::shared_ptr<const FingerModel> finger_ =
      FingerModel::load(kWearerProject / "fingers" / "index.toml");
  std::shared_ptr<const Device> device_ =
      load_device(kWearerProject / "devices" / "thimble-3rrs.toml");
  std::vector<PlannedPress> plan_ = plan_presses(*device_, *finger_, 1.5 * mm);

  /// 0.2 to 0.8 mm into the skin.
  [[nodiscard]] std::vector<Configuration> path_of(const PlannedPress& press) const {
    std::vector<Configuration> path;
    for (const double depth : {0.43, 0.7, 1.0}) {
      Configuration q = press.tilted;
      device_->advance(press.touch + depth * mm, q);
      path.push_back(q);
    }
    return path;
  }
};

TEST_F(PressModelTest, DerivativesAreThoseOfForces) {
  auto smooth = std::make_shared<FingerModel>(*finger_);
  smooth->feature_contact = false;  // planes that are chosen anew have no derivative
  PressModel model(smooth, device_, 0.0, TwinPrecision::kJudging);
  TraitVector x;
  x << 0.3, -0.4, 0.2, 0.5, -0.3, 0.1, 0.6, -0.5, 0.4;
  for (const std::size_t k : {std::size_t{0}, std::size_t{2}, std::size_t{5}}) {
    const PlannedPress& press = plan_[k];
    const std::vector<Configuration> path = path_of(press);
    model.put(x);
    const auto here = model.press(press.tilted, path, true);
    ASSERT_GT(here.back().force, 0.1) << "it presses";
    for (int i = 0; i < kWearerTraits; ++i) {
      constexpr double kStep = 1e-3;
      TraitVector other = x;
      other[i] = x[i] + kStep;
      model.put(other);
      const auto more = model.press(press.tilted, path, false);
      other[i] = x[i] - kStep;
      model.put(other);
      const auto less = model.press(press.tilted, path, false);
      for (std::size_t n = 0; n < path.size(); ++n) {
        const double expected = (more[n].force - less[n].force) / (2.0 * kStep);
        const double largest = here[n].by_trait.cwiseAbs().maxCoeff();
        EXPECT_NEAR(here[n].by_trait[i], expected, 1e-4 * largest)
            << kWearerTraitRows[static_cast<std::size_t>(i)].name << " of press " << k
            << ", reading " << n << ", largest " << largest << ", force " << here[n].force;
      }
    }
  }
}

// Edges that are looked for anew may be others in a skin a nanometre deeper.
TEST_F(PressModelTest, ADerivativeByDepthDoesNotJumpWithTheEdgesThatAreMet) {
  PressModel model(finger_, device_, 0.0);
  TraitVector x;
  x << -0.075, 0.1, -0.05, -0.125, 0.075, -0.025, -0.15, 0.125, -0.1;
  constexpr auto kDepthTrait = static_cast<Eigen::Index>(WearerTrait::kDepth);
  constexpr double kStep = 0.02;
  int compared = 0;
  for (const PlannedPress& press : plan_) {
    const std::vector<Configuration> path = path_of(press);
    const auto forces_at = [&](double step) {
      TraitVector other = x;
      other[kDepthTrait] += step;
      model.put(other);
      return model.press(press.tilted, path, step == 0.0);
    };
    const auto here = forces_at(0.0);
    const auto more = forces_at(kStep);
    const auto less = forces_at(-kStep);
    for (std::size_t n = 0; n < path.size(); ++n) {
      if (here[n].force < 0.03) continue;
      ++compared;
      const double expected = (more[n].force - less[n].force) / (2.0 * kStep);
      EXPECT_NEAR(here[n].by_trait[kDepthTrait], expected, here[n].force)
          << "tilted by " << press.pitch / deg << ", " << press.roll / deg << ", reading " << n;
    }
  }
  EXPECT_GT(compared, 15);
}

TEST_F(PressModelTest, FindsTheSameForcesFromWhereTheSkinWas) {
  PressModel model(finger_, device_, 0.0);
  const PlannedPress& press = plan_[3];
  const std::vector<Configuration> path = path_of(press);
  PressedSkin skin;
  (void)model.press(press.tilted, path, false, skin);
  TraitVector x;
  x << 0.2, -0.1, 0.2, 0.1, -0.2, -0.2, 0.3, -0.1, 0.4;
  model.put(x);
  const auto fresh = model.press(press.tilted, path, false);
  const auto remembered = model.press(press.tilted, path, false, skin);
  ASSERT_GT(fresh.back().force, 0.1) << "it presses";
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_NEAR(remembered[i].force, fresh[i].force, 2e-3 * fresh[i].force) << i;
  }
}

TEST_F(PressModelTest, FindsTheAdvanceForAForceFromWithinTheSkin) {
  PressModel model(finger_, device_, 0.0);
  for (const PlannedPress& press : plan_) {
    ReachedForce from_off, from_within;
    ASSERT_TRUE(model.advance_for(press.tilted, 0.1, 10.0 * mm, from_off));
    Configuration within = press.tilted;
    device_->advance(from_off.advance + 1.0 * mm, within);
    ASSERT_TRUE(model.advance_for(within, 0.1, 10.0 * mm, from_within));
    EXPECT_NEAR(from_within.there.force, 0.1, 1e-3);
    EXPECT_NEAR(from_within.advance, -1.0 * mm, 2e-3 * mm);
  }
}

TEST_F(PressModelTest, FindsTheSameAdvanceFromWhereItWas) {
  PressModel model(finger_, device_, 0.0);
  TraitVector x;
  x << 0.2, -0.1, 0.2, 0.1, -0.2, -0.2, 0.3, -0.1, 0.4;
  for (const double part : {1.0, 3.0}) {  // hardly different, and not
    double moved = 0.0;
    for (const PlannedPress& press : plan_) {
      model.put(TraitVector::Zero());
      ReachedForce reached, fresh;
      ASSERT_TRUE(model.advance_for(press.tilted, 0.1, 10.0 * mm, reached));
      const double before = reached.advance;
      model.put(part * x);
      ASSERT_TRUE(model.advance_for(press.tilted, 0.1, 10.0 * mm, fresh));
      ASSERT_TRUE(model.advance_for(press.tilted, 0.1, 10.0 * mm, reached));
      // Where the skin meets the disk's rim the way there counts a little.
      EXPECT_NEAR(reached.advance, fresh.advance, 0.02 * mm);
      moved = std::max(moved, std::abs(fresh.advance - before));
    }
    EXPECT_GT(moved, part * 0.1 * mm) << "these traits matter";
  }
}

TEST_F(PressModelTest, FindsNoAdvanceBeyondTheMostAndOneLater) {
  PressModel model(finger_, device_, 0.0);
  const PlannedPress& press = plan_.front();
  ReachedForce reached;
  EXPECT_FALSE(model.advance_for(press.tilted, 0.1, 0.5 * press.touch, reached));
  const double touched = press.touch + 0.05 * mm;
  EXPECT_FALSE(model.advance_for(press.tilted, 0.1, touched, reached));
  ASSERT_TRUE(model.advance_for(press.tilted, 0.1, 10.0 * mm, reached));
  EXPECT_GT(reached.advance, touched);
  const double found = reached.advance;
  EXPECT_FALSE(model.advance_for(press.tilted, 0.1, touched, reached));
  ASSERT_TRUE(model.advance_for(press.tilted, 0.1, 10.0 * mm, reached));
  EXPECT_NEAR(reached.advance, found, 2e-3 * mm);
}

TEST_F(PressModelTest, SaysWhatNobodyBearsWithoutLookingFurther) {
  PressModel model(finger_, device_, 0.0);
  const PlannedPress& press = plan_.front();
  std::vector<Configuration> path;
  for (const double depth : {0.5, 6.0, 7.0}) {
    Configuration q = press.tilted;
    device_->advance(press.touch + depth * mm, q);
    path.push_back(q);
  }
  const auto felt = model.press(press.tilted, path, true);
  ASSERT_EQ(felt.size(), 3U);
  EXPECT_LT(felt[0].force, 1.0);
  EXPECT_GT(felt[0].force, 0.0);
  for (const std::size_t i : {1U, 2U}) {
    EXPECT_EQ(felt[i].force, PressModel::kUnbearable);
    EXPECT_TRUE(felt[i].by_trait.isZero(0.0));
  }
}

TEST_F(PressModelTest, FindsTheAdvanceForAForce) {
  PressModel model(finger_, device_, 0.0);
  for (const PlannedPress& press : plan_) {
    ReachedForce reached;
    ASSERT_TRUE(model.advance_for(press.tilted, 0.1, 10.0 * mm, reached));
    EXPECT_NEAR(reached.there.force, 0.1, 1e-3);
    EXPECT_GT(reached.advance, press.touch);
    Configuration q = press.tilted;
    device_->advance(reached.advance, q);
    // Where the skin meets the disk's rim the way there counts a little.
    EXPECT_NEAR(model.press(press.tilted, {{q}}, false).front().force, 0.1, 1e-2);
    EXPECT_GT(reached.there.by_advance, 0.0);
  }
}

}  // namespace
}  // namespace softfinger
