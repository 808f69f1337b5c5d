#include <gtest/gtest.h>

#include "../support/folders.hpp"
#include "pad.hpp"
#include "softfinger/matching/deviation_minimiser.hpp"

namespace softfinger {
namespace {

// The thimble described body by body is matched as its closed form is, whatever the limits.
TEST(MechanismMatching, AgreesWithTheClosedForm) {
  const std::shared_ptr<const Device> by_bodies =
      load_device(source_folder() + "/devices/thimble-3rrs-mechanism.toml");
  std::mt19937 random(21);
  ContactSurfaceMatching closed_form(thimble(), 120);
  ContactSurfaceMatching general(by_bodies, 120);
  int limited = 0;
  for (int i = 0; i < 60; ++i) {
    const Pad pad = random_press(random, 40.0);
    for (const MatchingLimits limits : {MatchingLimits::kInside, MatchingLimits::kNone}) {
      MatchingOptions options;
      options.limits = limits;
      const MatchingResult expected = closed_form.solve(pad.view(), options);
      const MatchingResult result = general.solve(pad.view(), options);
      limited += expected.active_constraints.any() ? 1 : 0;
      EXPECT_LT((result.configuration - expected.configuration).cwiseAbs().maxCoeff(), 1e-6);
      EXPECT_NEAR(result.deviation, expected.deviation, 1e-9 * expected.deviation + 1e-18);
      EXPECT_EQ(result.joints_exist, expected.joints_exist);
    }
  }
  EXPECT_GT(limited, 5);
}

// More freedom renders no worse.
TEST(MechanismMatching, SixDegreesOfFreedomRenderAtLeastAsWellAsThree) {
  const std::shared_ptr<const Device> plate =
      load_device(source_folder() + "/devices/plate-6dof.toml");
  std::mt19937 random(22);
  ContactSurfaceMatching three(thimble(), 120);
  ContactSurfaceMatching six(plate, 120);
  for (int i = 0; i < 20; ++i) {
    const Pad pad = random_press(random, 15.0);
    const MatchingResult with_three = three.solve(pad.view(), {});
    const MatchingResult with_six = six.solve(pad.view(), {});
    EXPECT_TRUE(with_six.joints_exist);
    EXPECT_LE(with_six.deviation, with_three.deviation * 1.001 + 1e-15);
  }
}

// A disk may turn about its normal at will. That valley of E bends in the plate's coordinates: it
// is walked with a strong pull home, not in steps that the bend cuts. Some ways end at a kink of
// limits.
TEST(MechanismMatching, AWayAlongAValleyComesToItsEnd) {
  const std::shared_ptr<const Device> plate =
      load_device(source_folder() + "/devices/plate-6dof.toml");
  std::mt19937 random(23);
  DeviationMinimiser minimiser(*plate);
  int touching = 0;
  int limited = 0;
  for (int i = 0; i < 100; ++i) {
    const Pad pad = random_press(random, 15.0);
    if (pad.contacts() == 0) continue;
    ++touching;
    const PackedPad packed(pad);
    const DeviationMinimiser::Outcome outcome =
        minimiser.minimise(packed.view(), plate->home(), true, 60);
    EXPECT_TRUE(outcome.valid);
    limited += outcome.termination == Termination::kIterationLimit ? 1 : 0;
  }
  EXPECT_GT(touching, 60);
  EXPECT_LE(limited, 3);
}

}  // namespace
}  // namespace softfinger
