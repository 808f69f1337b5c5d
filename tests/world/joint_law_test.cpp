#include "softfinger/world/joint_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

constexpr double kLimitStiffness = 1e6;

Joint slider() {
  return {.kind = JointKind::kSlider,
          .limits = std::array{-2.5 * mm, 0.5 * mm},
          .spring = 200.0,
          .rest = 0.1 * mm,
          .friction = 0.2,
          .curve = JointCurve{{0.0, 1.0 * mm, 1.4 * mm, 2.5 * mm}, {0.0, 1.2, 0.7, 2.5}}};
}

Joint knob() {
  return {.kind = JointKind::kHinge, .friction = 1e-3, .detents = JointDetents{24, 4e-3}};
}

/// Force and stiffness against differences of energy and force.
template <typename Value>
void expect_derivatives(const Value& value, const std::vector<double>& places, double step) {
  for (const double q : places) {
    const LawValue before = value(q - step), at = value(q), after = value(q + step);
    const double force = (after.energy - before.energy) / (2.0 * step);
    const double stiffness = (after.force - before.force) / (2.0 * step);
    EXPECT_NEAR(at.force, force, 1e-5 * std::abs(force) + 1e-6) << q;
    EXPECT_NEAR(at.stiffness, stiffness, 1e-3 * std::abs(stiffness) + 1e-3) << q;
  }
}

TEST(JointLaw, ForceAndStiffnessAreDerivativesOfEnergy) {
  const JointLaw button(slider(), kLimitStiffness);
  const auto of_button = [&](double q) { return button.evaluate(q); };
  expect_derivatives(of_button, {-2.4 * mm, -1.2 * mm, -0.7 * mm, 0.0003, 0.0}, 1e-7);
  // About a limit that takes hold within a micrometre.
  expect_derivatives(of_button, {0.5 * mm + 0.4e-6, 0.5 * mm + 3e-6, -2.5 * mm - 0.7e-6}, 1e-9);
  const JointLaw detents(knob(), kLimitStiffness);
  expect_derivatives([&](double q) { return detents.evaluate(q); }, {-7.0, 0.1, 0.2, 5.0}, 1e-5);
  expect_derivatives([&](double q) { return button.friction(q, 1.0 * mm); },
                     {1.0 * mm + 0.5e-6, 1.0 * mm - 0.9e-6, 1.2 * mm, 0.5 * mm}, 1e-9);
}

TEST(JointLaw, APressedButtonPushesBackByItsCurve) {
  Joint joint = slider();
  joint.spring = 0.0;
  const JointLaw law(joint, kLimitStiffness);
  EXPECT_NEAR(law.evaluate(-1.0 * mm).force, -1.2, 1e-12);
  EXPECT_NEAR(law.evaluate(-1.4 * mm).force, -0.7, 1e-12);
  ASSERT_EQ(law.snaps().size(), 1U);
  EXPECT_NEAR(law.snaps()[0].top, 1.0 * mm, 1e-15);
  // Between top and valley it gives way.
  EXPECT_LT(law.evaluate(-1.2 * mm).stiffness, -1500.0);
}

TEST(JointLaw, ALimitTakesHoldWithoutAJump) {
  Joint joint{.kind = JointKind::kSlider, .limits = std::array{-1.0 * mm, 1.0 * mm}};
  const JointLaw law(joint, kLimitStiffness);
  for (const double q : {-1.0 * mm, 0.0, 1.0 * mm}) EXPECT_EQ(law.evaluate(q).stiffness, 0.0);
  const double w = JointLaw::kOnset;
  for (const double edge : {1.0 * mm, 1.0 * mm + w}) {
    const LawValue before = law.evaluate(edge - 1e-12), after = law.evaluate(edge + 1e-12);
    EXPECT_NEAR(before.energy, after.energy, 1e-11);
    EXPECT_NEAR(before.force, after.force, 1e-5);
    EXPECT_NEAR(before.stiffness, after.stiffness, 1e-5 * kLimitStiffness);
  }
  EXPECT_NEAR(law.evaluate(1.01 * mm).force, kLimitStiffness * (10e-6 - w / 2.0), 1e-9);
  EXPECT_NEAR(law.evaluate(-1.01 * mm).force, -law.evaluate(1.01 * mm).force, 1e-9);
  EXPECT_NEAR(law.beyond_limits(-1.01 * mm), 10e-6, 1e-15);
  EXPECT_NEAR(law.beyond_limits(0.4 * mm), -0.6 * mm, 1e-15);
  EXPECT_EQ(JointLaw(knob(), kLimitStiffness).beyond_limits(1e3), -kEndless);
}

TEST(JointLaw, DetentsPullToWholeParts) {
  const JointLaw law(knob(), kLimitStiffness);
  const double part = 2.0 * std::numbers::pi / 24;
  EXPECT_NEAR(law.evaluate(0.25 * part).force, 4e-3, 1e-15);
  EXPECT_NEAR(law.evaluate(-0.25 * part).force, -4e-3, 1e-15);
  for (const long k : {-25L, -1L, 0L, 3L, 24L}) {
    const double q = static_cast<double>(k) * part;
    EXPECT_NEAR(law.evaluate(q).force, 0.0, 1e-15);
    EXPECT_GT(law.evaluate(q).stiffness, 0.0);
    EXPECT_EQ(law.detent(q + 0.49 * part), k);
    EXPECT_EQ(law.detent(q - 0.49 * part), k);
  }
}

TEST(JointLaw, LeastStiffnessIsThatOfASearchWithinLimits) {
  std::vector<Joint> joints{slider(), knob(), knob(), knob()};
  joints[2].limits = {-1.0 * deg, 2.0 * deg};
  joints[3].limits = {8.0 * deg, 12.0 * deg};
  joints[3].spring = 0.5;
  for (const Joint& joint : joints) {
    const JointLaw law(joint, kLimitStiffness);
    const auto [from, to] = joint.limits.value_or(std::array{-1.0, 1.0});
    double least = kEndless;
    for (int i = 0; i <= 10000; ++i) {
      least = std::min(least, law.evaluate(from + (to - from) * i * 1e-4).stiffness);
    }
    EXPECT_LE(law.least_stiffness(), least + 1e-12);
    EXPECT_NEAR(law.least_stiffness(), least, 3e-3 * std::abs(least));  // limits give a little
  }
}

TEST(JointLaw, DryFrictionHoldsUpToItsLimitAndIsDraggedAlong) {
  const JointLaw law(slider(), kLimitStiffness);
  double anchor = 0.0;
  EXPECT_NEAR(law.friction(0.5 * JointLaw::kStick, anchor).force, 0.1, 1e-12);
  EXPECT_EQ(law.anchor_after(0.5 * JointLaw::kStick, anchor), anchor);
  anchor = law.anchor_after(1.0 * mm, anchor);
  EXPECT_NEAR(law.friction(1.0 * mm, anchor).force, 0.2, 1e-9) << "as it slid";
  EXPECT_NEAR(law.friction(2.0 * mm, anchor).force, 0.2, 1e-12);
  EXPECT_NEAR(law.friction(1.0 * mm - 2.0 * JointLaw::kStick, anchor).force, -0.2, 1e-9)
      << "held back the other way";
  // Work of a slide forth and back: twice its length times the limit.
  double work = 0.0, q = 0.0;
  anchor = 0.0;
  for (int i = 1; i <= 2000; ++i) {
    const double next = (i <= 1000 ? i : 2000 - i) * 1e-6;
    work += law.friction(next, anchor).force * (next - q);
    q = next;
    anchor = law.anchor_after(q, anchor);
  }
  EXPECT_NEAR(work, 0.2 * 2.0 * mm, 0.005 * work);
  EXPECT_EQ(JointLaw(Joint{.kind = JointKind::kSlider}, 1.0).friction(1.0, 0.0).force, 0.0);
}

}  // namespace
}  // namespace softfinger
