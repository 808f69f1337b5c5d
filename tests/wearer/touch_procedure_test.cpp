// The touches by which a device without a force sensor learns its wearer, told by somebody.

#include "softfinger/wearer/touch_procedure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_model.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;

constexpr double kTouchTick = 1.0 / 30.0;  // s

class TouchProcedureTest : public testing::Test {
 protected:
  /// How far the skin is from the model's, m, by tilt.
  using Skin = std::function<double(const PlannedPress& press)>;

  struct Told {
    double reaction = 0.2;  ///< s
    /// Instead of a word some time after a touch: at this time, s, whatever is felt.
    std::optional<double> at;
    bool never = false, always = false;
  };

  struct Touched {
    std::string failure;
    bool done = false;
    bool retracts = false;
    std::vector<TouchRecord> touches;
    double deepest = 0.0;  ///< beyond the skin, m
    double time = 0.0;
  };

  [[nodiscard]] Touched touch(const Skin& skin, const Told& told) const {
    TouchProcedure procedure(*device_, plan_, kTouchTick);
    Touched touched;
    constexpr double kNever = 1e9;  // s
    constexpr double kAgain = 1.0;  // s, until somebody says it again
    double felt_at = kNever;
    Configuration stands = device_->home();
    for (int i = 0; i < 6000 && !procedure.done() && procedure.failure().empty(); ++i) {
      // The device follows a tick later.
      const Configuration next = procedure.wanted();
      const double time = i * kTouchTick;
      const PlannedPress& press = *procedure.under_way();
      // Turned as for this touch; on the way from the last it is off the skin.
      Configuration level = press.tilted;
      device_->advance(advance_of(press, stands), level);
      const bool turned = (stands - level).norm() < 1e-9;
      const double depth =
          turned ? advance_of(press, stands) - press.touch - skin(press) : -1.0 * mm;
      touched.deepest = std::max(touched.deepest, depth);
      bool says = false;
      if (depth <= 0.0) {
        felt_at = kNever;
      } else {
        if (felt_at == kNever) felt_at = time;
      }
      if (!told.never && time >= felt_at + told.reaction) {
        says = true;
        felt_at = time + kAgain - told.reaction;
      }
      if (told.always) says = true;
      if (told.at) says = std::abs(time - *told.at) < 0.5 * kTouchTick;
      procedure.advance({.time = time, .stands = stands, .told = says});
      stands = next;
    }
    touched.failure = procedure.failure();
    touched.done = procedure.done();
    touched.retracts = procedure.wanted() == device_->retracted();
    touched.touches = procedure.touches();
    touched.time = procedure.duration();
    return touched;
  }

  [[nodiscard]] double advance_of(const PlannedPress& press, const Configuration& q) const {
    Configuration ahead = Configuration::Zero(q.size());
    device_->advance(1.0, ahead);
    return (q - press.tilted).dot(ahead) / ahead.squaredNorm();
  }

  std::shared_ptr<const FingerModel> finger_ =
      FingerModel::load(source_folder() + "/fingers/index.toml");
  std::shared_ptr<const Device> device_ =
      load_device(source_folder() + "/devices/thimble-3rrs.toml");
  std::vector<PlannedPress> plan_ = plan_presses(*device_, *finger_, 0.5 * mm);
};

TEST_F(TouchProcedureTest, FindsTheSkinOfEachTiltWithoutPressingOnIt) {
  // Further off, or nearer, and leaning.
  for (const double off : {-1.5 * mm, 0.0, 1.0 * mm}) {
    const auto skin = [off](const PlannedPress& press) {
      return off + 1.5 * mm * press.pitch - 1.0 * mm * press.roll;
    };
    const Touched touched = touch(skin, {});
    EXPECT_EQ(touched.failure, "") << off;
    ASSERT_TRUE(touched.done);
    ASSERT_EQ(touched.touches.size(), plan_.size());
    EXPECT_LT(touched.deepest, 0.35 * mm);
    EXPECT_LT(touched.time, 60.0);
    for (std::size_t i = 0; i < plan_.size(); ++i) {
      const TouchRecord& record = touched.touches[i];
      const double at = advance_of(plan_[i], record.start) + record.advance;
      // Within two ticks at 1 mm/s.
      EXPECT_NEAR(at, plan_[i].touch + skin(plan_[i]), 0.07 * mm) << off << " " << i;
      EXPECT_GT(record.advance, 0.0);
    }
  }
}

TEST_F(TouchProcedureTest, SomebodyWhoSaysNothingIsNotPressed) {
  const Touched touched = touch([](const PlannedPress&) { return 0.0; }, {.never = true});
  EXPECT_THAT(touched.failure, HasSubstr("no touch was told within 1.2 mm past"));
  EXPECT_TRUE(touched.retracts);
  EXPECT_LT(touched.deepest, 1.4 * mm);
  EXPECT_GT(touched.deepest, 1.0 * mm);
  EXPECT_TRUE(touched.touches.empty());
}

TEST_F(TouchProcedureTest, AWordWhereATouchWouldBeginIsAskedForAgainFurtherOff) {
  // Once, of somebody who is not touched: nothing is learned from it.
  for (const double at : {0.3, 0.5}) {
    const Touched touched = touch([](const PlannedPress&) { return 0.0; }, {.at = at});
    EXPECT_THAT(touched.failure, HasSubstr("no touch was told")) << at;
    EXPECT_TRUE(touched.touches.empty());
  }
  // Skin that is nearer than anybody thought.
  const Touched near = touch([](const PlannedPress&) { return -4.5 * mm; }, {});
  EXPECT_EQ(near.failure, "");
  EXPECT_EQ(near.touches.size(), plan_.size());
  // Somebody who says so all the time.
  const Touched always = touch([](const PlannedPress&) { return 0.0; }, {.always = true});
  EXPECT_THAT(always.failure, HasSubstr("wherever one would begin"));
  EXPECT_TRUE(always.retracts);
}

TEST_F(TouchProcedureTest, LooksNoFurtherThanTheDeviceReaches) {
  std::vector<PlannedPress> short_way = plan_;
  for (PlannedPress& press : short_way) press.most = press.touch + 0.2 * mm;
  TouchProcedure procedure(*device_, short_way, kTouchTick);
  Configuration stands = device_->home();
  for (int i = 0; i < 3000 && procedure.failure().empty(); ++i) {
    procedure.advance({.time = i * kTouchTick, .stands = stands, .told = false});
    stands = procedure.wanted();
  }
  EXPECT_THAT(procedure.failure(), HasSubstr("a limit of the device ends before the skin"));
}

}  // namespace
}  // namespace softfinger
