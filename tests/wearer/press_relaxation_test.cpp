// What relaxation takes from the force of a press.

#include "softfinger/wearer/press_relaxation.hpp"

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

/// One finger neared at 3 mm/s and pressed at 1 mm/s as it relaxes, and as if it did not.
struct RelaxingPress {
  std::shared_ptr<const FingerModel> finger =
      FingerModel::load(kUseProject / "fingers" / "index-viscoelastic.toml");
  std::shared_ptr<const Device> device = load_device(kUseProject / "devices" / "thimble-3rrs.toml");
  static constexpr double kApproach = 3e-3;       // m/s, until it touches
  static constexpr double kSpeed = 1e-3;          // m/s
  static constexpr int kSteady = 3;               // ticks after that
  static constexpr double kElapsed = 1.0 / 30.0;  // s
  std::vector<PressRecord> felt, lasting;         ///< two, the second turned, half a second apart

  RelaxingPress() {
    auto without = std::make_shared<FingerModel>(*finger);
    without->relaxation.terms.clear();
    Twin relaxing_twin(finger, device);
    Twin lasting_twin(without, device);
    double time = 0.0;
    for (int press = 0; press < 2; ++press) {
      felt.emplace_back();
      lasting.emplace_back();
      // Turned as the presses of a fit are.
      Configuration q = device->facing(
          exp_rotation({press * 15.0 * deg, 0.0, 0.0}) * Vector3::UnitZ(), device->home());
      for (int tick = 0; tick < 15; ++tick, time += kElapsed) {
        relaxing_twin.press(q, 0.0, kElapsed);
        lasting_twin.press(q, 0.0, kElapsed);
      }
      device->advance(2.0 * mm, q);
      for (int tick = 0, touching = 0; touching < 30; ++tick, time += kElapsed) {
        device->advance((touching > 0 ? kSpeed : kApproach) * kElapsed, q);
        relaxing_twin.press(q, 0.0, kElapsed);
        lasting_twin.press(q, 0.0, kElapsed);
        const double force = relaxing_twin.contact().normal_force;
        if (touching > 0 || force > 0.05) ++touching;
        PressRecord& record = felt.back();
        (touching > kSteady ? record.readings : record.approach).push_back({q, force, 1.0, time});
        if (touching <= kSteady) continue;
        lasting.back().readings.push_back({q, lasting_twin.contact().normal_force, 1.0, time});
      }
    }
  }
};

const RelaxingPress& relaxing_press() {
  static const RelaxingPress press;
  return press;
}

TEST(StiffnessInUse, APressIsThatMuchSofter) {
  const RelaxingPress& press = relaxing_press();
  const double lasting = press.lasting.front().readings.back().force;
  ASSERT_GT(lasting, 0.4);
  const double softer = press.felt.front().readings.back().force / lasting;
  EXPECT_NEAR(softer * stiffness_in_use(*press.finger, RelaxingPress::kSpeed), 1.0, 0.06);
  EXPECT_LT(softer, 0.6);
}

TEST(WithoutRelaxation, PressesAreThoseOfSkinThatLasts) {
  const RelaxingPress& press = relaxing_press();
  const std::vector<PressRecord> found = without_relaxation(press.felt, press.finger->relaxation);
  ASSERT_EQ(found.size(), 2U);
  for (std::size_t k = 0; k < found.size(); ++k) {
    ASSERT_GT(found[k].readings.size(), 12U);
    // How much of the first press is under the second is a guess.
    const double tolerance = k == 0 ? 0.01 : 0.04;
    for (std::size_t i = 0; i < found[k].readings.size(); ++i) {
      EXPECT_EQ(found[k].readings[i].q, press.felt[k].readings[i].q);
      const double wanted = press.lasting[k].readings[i].force;
      EXPECT_NEAR(found[k].readings[i].force, wanted, tolerance * wanted) << k << " " << i;
    }
  }
  const PressRecord alone = without_relaxation({press.felt[1]}, press.finger->relaxation).front();
  EXPECT_LT(alone.readings[4].force, 0.95 * press.lasting[1].readings[4].force)
      << "the skin has recovered in between";
}

TEST(WithoutRelaxation, ForceThatIsHeldGrowsByWhatWasLost) {
  // A step that is held, felt at any times: 1 - sum g (1 - exp(-t / tau)) of it is left.
  const Relaxation relaxation{{{0.3, 0.05}, {0.2, 1.4}}};
  PressRecord held;
  constexpr double kSoon = 1e-3;  // s
  double time = 0.0;
  held.readings.push_back({{}, 0.0, 1.0, time});
  for (int i = 0; i < 60; ++i) {
    time += i == 0 ? kSoon : 0.01 * (1 + i % 3);
    double left = 1.0;
    for (const Relaxation::Term& term : relaxation.terms) {
      left -= term.fraction * (1.0 - std::exp(-(time - 0.5 * kSoon) / term.time));
    }
    held.readings.push_back({{}, left, 1.0, time});
  }
  const PressRecord found = without_relaxation({held}, relaxation).front();
  for (std::size_t i = 1; i < found.readings.size(); ++i) {
    EXPECT_NEAR(found.readings[i].force, 1.0, 1e-3) << i;
  }
}

TEST(WithoutRelaxation, IsTheSamePressWhereNothingRelaxes) {
  const std::vector<PressRecord>& felt = relaxing_press().felt;
  const std::vector<PressRecord> found = without_relaxation(felt, {});
  EXPECT_EQ(found.back().readings.back().force, felt.back().readings.back().force);
  EXPECT_TRUE(without_relaxation({{}}, {{{0.3, 0.05}}}).front().readings.empty());
}

TEST(StiffnessInUse, IsThatOfThePressWhereNothingRelaxes) {
  const auto finger = FingerModel::load(kUseProject / "fingers" / "index.toml");
  EXPECT_EQ(stiffness_in_use(*finger, 1e-3), 1.0);
}

}  // namespace
}  // namespace softfinger
