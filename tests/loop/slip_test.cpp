// A device that slips aside while it is worn, followed by the force that is measured.

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/loop/emulated_force_sensor.hpp"
#include "softfinger/loop/travel_offset.hpp"
#include "softfinger/sensing/force_sensor_emulator.hpp"

namespace softfinger {
namespace {

constexpr double kTick = 1.0 / 30.0;
constexpr int kSlips = 180;  // tick
constexpr int kEnds = 720;
constexpr int kShort = 260;

class SlipTest : public testing::Test {
 protected:
  /// Of the normal force, as parts of it: means over ticks that press.
  struct Errors {
    double before = 0.0, at_once = 0.0, after = 0.0;
    TravelOffset offset;
  };

  /// Presses from ever other tilts, while the device slips by `slip`, F, m.
  Errors worn(const TravelOffsetOptions& options, const Vector3& slip, int ends = kEnds) {
    Errors errors{.offset = TravelOffset(finger_, device_, options)};
    TravelOffset& offset = errors.offset;
    Twin model(finger_, device_);
    EmulatedForceSensor sits(finger_, device_);
    EmulatedForceSensor slipped(finger_, device_->mounted({Matrix3::Identity(), slip}));
    FaultyForce says(0.02, 1);
    double sums[3] = {};
    int counts[3] = {};
    for (int tick = 0; tick < ends; ++tick) {
      const Configuration q = wanted(tick);
      model.press(q, 0.0, kTick);
      const Configuration sent = offset.corrected(q);
      const double felt = (tick < kSlips ? sits : slipped).press(sent, 0.0, kTick);
      const double meant = model.contact().normal_force;
      if (meant > 0.1) {
        const int when =
            tick < kSlips ? 0 : (tick < kSlips + 60 ? 1 : (tick < ends - 240 ? -1 : 2));
        if (when >= 0) {
          sums[when] += std::abs(felt - meant) / meant;
          ++counts[when];
        }
      }
      offset.update({*says.reading(felt), sent}, 0.0, kTick);
    }
    errors.before = sums[0] / counts[0];
    errors.at_once = sums[1] / counts[1];
    errors.after = sums[2] / counts[2];
    return errors;
  }

  std::shared_ptr<const FingerModel> finger_ =
      FingerModel::load(std::filesystem::path(source_folder()) / "fingers" / "index.toml");
  std::shared_ptr<const Device> device_ =
      load_device(std::filesystem::path(source_folder()) / "devices" / "thimble-3rrs.toml");

 private:
  [[nodiscard]] static Configuration wanted(int tick) {
    const double turn = 2.0 * std::numbers::pi * tick * kTick;
    Configuration q(3);
    q << 0.3 * std::sin(0.31 * turn), 0.25 * std::sin(0.43 * turn),
        (3.4 + 0.4 * std::sin(1.1 * turn)) * mm;
    return q;
  }
};

TEST_F(SlipTest, AMillimetreAsideIsLearned) {
  const Vector3 slip(1.0 * mm, 0.0, 0.0);
  const Errors plain = worn({}, slip);
  const Errors refined = worn({.refine = true}, slip);
  const Errors open = worn({.max_change = 0.0}, slip);
  std::cout << "force error before, in the two seconds after, and later: uncorrected "
            << open.before << " " << open.at_once << " " << open.after << "; travel alone "
            << plain.before << " " << plain.at_once << " " << plain.after << "; refined "
            << refined.before << " " << refined.at_once << " " << refined.after << "; slip "
            << refined.offset.slip().transpose() << "\n";
  EXPECT_GT(open.after, 0.2);
  EXPECT_LT(refined.after, 0.8 * plain.after);
  EXPECT_LT(refined.after, 0.5 * open.after);
}

TEST_F(SlipTest, NothingIsLearnedOfADeviceThatSits) {
  const Errors refined = worn({.refine = true}, Vector3::Zero(), 480);
  EXPECT_LT(refined.offset.slip().norm(), 0.3 * mm);
  EXPECT_LT(refined.after, 1.2 * worn({}, Vector3::Zero(), 480).after + 0.01);
}

TEST_F(SlipTest, WhatIsLearnedIsBoundedAndRepeatsToTheBit) {
  TravelOffsetOptions options{.refine = true, .max_slip = 0.1 * mm};
  const Errors errors = worn(options, {1.0 * mm, 1.0 * mm, 0.5 * mm}, kShort);
  EXPECT_LE(errors.offset.slip().cwiseAbs().maxCoeff(), 0.1 * mm);
  EXPECT_GT(errors.offset.slip().cwiseAbs().maxCoeff(), 0.08 * mm);
  options.max_slip = 2.0 * mm;
  const Errors once = worn(options, {1.0 * mm, 0.0, 0.0}, kShort);
  const Errors again = worn(options, {1.0 * mm, 0.0, 0.0}, kShort);
  EXPECT_GT(once.offset.slip().norm(), 0.12 * mm) << "without that bound";
  EXPECT_EQ(once.offset.slip(), again.offset.slip());
  EXPECT_EQ(once.offset.value(), again.offset.value());
}

}  // namespace
}  // namespace softfinger
