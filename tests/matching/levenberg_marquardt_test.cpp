#include "softfinger/matching/levenberg_marquardt.hpp"

#include <gtest/gtest.h>

#include "../support/folders.hpp"
#include "pad.hpp"
#include "random_descent.hpp"
#include "softfinger/matching/packed_samples.hpp"

namespace softfinger {
namespace {

constexpr MatchingOptions kUnlimited{.limits = MatchingLimits::kNone,
                                     .separation = Separation::kConstant};

std::shared_ptr<const Device> device_named(const std::string& name) {
  return load_device(source_folder() + "/devices/" + name + ".toml");
}

double deviation_of(const Device& device, const SurfaceSamples& samples, Configuration q, int k,
                    double step) {
  q[k] += step / device.axes()[static_cast<std::size_t>(k)].metric;
  return device.deviation(q, samples);
}

// Whatever moves and touches: no small step along an axis leads lower, and none of the way led up.
TEST(LevenbergMarquardt, EndsWhereNoAxisLeadsLower) {
  constexpr double kStep = 20e-6;  // m
  for (const char* name : {"thimble-3rrs", "plate-2dof", "delta-schorr", "membrane", "five-bar",
                           "pins-sarakoglou-4x4", "plate-6dof"}) {
    const auto device = device_named(name);
    LevenbergMarquardt minimiser(*device);
    std::mt19937 random(3);
    int moved = 0;
    for (int i = 0; i < 8; ++i) {
      const Pad pad = random_press(random, 15.0);
      if (pad.contacts() < 4) continue;
      PackedSamples packed(pad.size());
      const SurfaceSamples samples = packed.pack(pad.view(), kUnlimited, 0.2 * mm);
      const auto found = minimiser.minimise(samples, device->home());
      EXPECT_EQ(found.deviation, device->deviation(found.q, samples));
      EXPECT_LT(found.deviation, device->deviation(device->home(), samples)) << name;
      moved += found.iterations > 1 ? 1 : 0;
      if (found.termination != Termination::kConverged) continue;
      for (int k = 0; k < found.q.size(); ++k) {
        for (const double step : {kStep, -kStep}) {
          EXPECT_GE(deviation_of(*device, samples, found.q, k, step), found.deviation * (1 - 1e-9))
              << name << " " << i << " axis " << k;
        }
      }
    }
    EXPECT_GT(moved, 3) << name;
  }
}

// Of a plane there is one minimum, the plane itself but for the constant separation: who starts
// elsewhere comes to the same.
TEST(LevenbergMarquardt, ComesToOurMinimumWhereThereIsOne) {
  ContactSurfaceMatching matching(thimble(), 120);
  LevenbergMarquardt minimiser(*thimble());
  std::mt19937 random(5);
  const Pad rest = resting_pad(120, random);
  for (const double tilt : {0.0, 6.0, 14.0}) {
    const Vector3 normal(std::sin(tilt * deg), 0.0, std::cos(tilt * deg));
    const Pad pad = press_plane(rest, Vector3(0.0, 0.0, -5.6 * mm), normal);
    ASSERT_GT(pad.contacts(), 5);
    const MatchingResult ours = matching.solve(pad.view(), kUnlimited);
    PackedSamples packed(pad.size());
    const SurfaceSamples samples = packed.pack(pad.view(), kUnlimited, 0.2 * mm);
    for (const Configuration& start : {thimble()->home(), configuration(4.0, -5.0, 2.0)}) {
      const auto found = minimiser.minimise(samples, start);
      EXPECT_EQ(found.termination, Termination::kConverged);
      EXPECT_GT(found.iterations, 1);
      EXPECT_LT(std::sqrt(thimble()->squared_distance(found.q, ours.configuration)), 1e-7);
    }
  }
}

// Never lower than a search from several starts, now and then in a shallower valley; and who starts
// in the deepest stays there.
TEST(LevenbergMarquardt, StaysInTheValleyItStartsIn) {
  ContactSurfaceMatching matching(thimble(), 120);
  LevenbergMarquardt minimiser(*thimble());
  std::mt19937 random(11);
  constexpr double kNear = 1e-3;  // how near a search comes to the global minimum
  int shallower = 0, compared = 0;
  for (int i = 0; i < 120; ++i) {
    const Pad pad = random_press(random, 25.0);
    if (pad.contacts() < 3) continue;
    const MatchingResult ours = matching.solve(pad.view(), kUnlimited);
    PackedSamples packed(pad.size());
    const SurfaceSamples samples = packed.pack(pad.view(), kUnlimited, 0.2 * mm);
    const auto found = minimiser.minimise(samples, thimble()->home());
    EXPECT_GE(found.deviation, ours.deviation * (1.0 - kNear) - 1e-18) << i;
    EXPECT_LE(minimiser.minimise(samples, ours.configuration).deviation,
              ours.deviation * (1.0 + 1e-9) + 1e-18);
    shallower += found.deviation > 1.01 * ours.deviation + 1e-14 ? 1 : 0;
    ++compared;
  }
  EXPECT_GT(compared, 60);
  EXPECT_LT(shallower, compared / 2);
}

TEST(LevenbergMarquardt, StandsStillWhereNothingIsAmiss) {
  LevenbergMarquardt minimiser(*thimble());
  std::mt19937 random(7);
  Pad pad = resting_pad(60, random);
  PackedSamples packed(pad.size());
  const auto clear =
      minimiser.minimise(packed.pack(pad.view(), kUnlimited, 0.2 * mm), thimble()->home());
  EXPECT_EQ(clear.q, thimble()->home());
  EXPECT_EQ(clear.iterations, 0);
  // Skin that hangs lower is cleared by the separation, and no more.
  for (Vector3& p : pad.points) p.z() -= 4.0 * mm;
  const SurfaceSamples low = packed.pack(pad.view(), kUnlimited, 0.2 * mm);
  const auto cleared = minimiser.minimise(low, thimble()->home());
  EXPECT_GT(cleared.iterations, 0);
  EXPECT_NEAR(thimble()->least_distance(cleared.q, low), 0.2 * mm, 1e-6);
}

}  // namespace
}  // namespace softfinger
