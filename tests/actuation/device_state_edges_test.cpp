#include <gtest/gtest.h>

#include "softfinger/actuation/device_state.hpp"

namespace softfinger {
namespace {

constexpr double kStateTick = 0.01;

/// Far from time zero, so that a moment taken for a length of time shows.
class DeviceStateEdges : public testing::Test {
 protected:
  DeviceStateEdges() { go({.arrived = true}); }

  DeviceState go(DeviceStateMachine::Tick tick) {
    time += kStateTick;
    tick.time = time;
    return machine.advance(tick);
  }

  DeviceStateMachine machine;
  double time = 100.0;
};

TEST_F(DeviceStateEdges, TrackingThatWasLostForAMomentHomesAgain) {
  EXPECT_EQ(go({.tracked = false, .arrived = true}), DeviceState::kHolding);
  EXPECT_EQ(go({.arrived = true}), DeviceState::kHoming) << "wherever the finger is by now";
  EXPECT_EQ(go({.arrived = false}), DeviceState::kHoming);
  EXPECT_EQ(go({.arrived = true}), DeviceState::kReady);
}

TEST_F(DeviceStateEdges, EachLossOfTrackingHasItsOwnTime) {
  for (int loss = 0; loss < 3; ++loss) {
    for (int k = 0; k < 20; ++k) {
      ASSERT_EQ(go({.tracked = false, .arrived = true}), DeviceState::kHolding) << k;
    }
    go({.arrived = true});
    go({.arrived = true});
  }
  for (int k = 0; k < 20; ++k) go({.tracked = false, .arrived = true});
  EXPECT_EQ(go({.tracked = false, .arrived = true}), DeviceState::kRetracting);
}

TEST_F(DeviceStateEdges, AStalledLoopRetractsAtOnce) {
  EXPECT_EQ(go({.touching = true, .stalled = true, .arrived = true}), DeviceState::kRetracting);
  EXPECT_EQ(go({.touching = true, .arrived = true}), DeviceState::kHoming);
}

TEST_F(DeviceStateEdges, AnEndGivesUpByItsOwnTime) {
  double begin = 0.0;
  while (go({.ending = true}) == DeviceState::kRetracting) {
    if (begin == 0.0) begin = time;
    ASSERT_LT(time - begin, kLongestRetraction + 1.0);
  }
  EXPECT_NEAR(time - begin, kLongestRetraction, 1.5 * kStateTick);
}

// Whatever was retracted for long before it need not be repeated at the end.
TEST_F(DeviceStateEdges, AnEndOfWhatIsRetractedForLongIsAtOnce) {
  for (int k = 0; k < 100; ++k) go({.emergency = true, .arrived = true});
  EXPECT_EQ(go({.ending = true, .emergency = true, .arrived = true}), DeviceState::kStopped);
}

TEST_F(DeviceStateEdges, ARetractionBeforeIsNoneOfTheOneAtTheEnd) {
  for (int k = 0; k < 100; ++k) go({.emergency = true, .arrived = true});
  go({.arrived = true});
  EXPECT_EQ(go({.arrived = true}), DeviceState::kReady);
  for (int k = 0; k < 100; ++k) {
    ASSERT_EQ(go({.ending = true}), DeviceState::kRetracting) << "not there yet";
  }
  int repeats = 0;
  while (go({.ending = true, .arrived = true}) == DeviceState::kRetracting) ++repeats;
  EXPECT_NEAR(repeats * kStateTick, kRetractedRepeatTime, 1.01 * kStateTick);
}

// What is repeated counts from the first arrival, not the last.
TEST_F(DeviceStateEdges, ArrivingOnceIsEnough) {
  go({.ending = true});
  int repeats = 0;
  while (go({.ending = true, .arrived = repeats == 0}) == DeviceState::kRetracting) {
    ASSERT_LT(++repeats, 100);
  }
  EXPECT_NEAR(repeats * kStateTick, kRetractedRepeatTime, 1.01 * kStateTick);
}

TEST_F(DeviceStateEdges, AnEndDoesNotWaitForTracking) {
  go({.tracked = false, .arrived = true});
  EXPECT_EQ(go({.tracked = false, .ending = true, .arrived = true}), DeviceState::kRetracting);
}

TEST_F(DeviceStateEdges, AnEndThatIsTakenBackCountsAnewTheNextTime) {
  for (int k = 0; k < 2000; ++k) go({.ending = true});
  go({.ending = false});
  for (int k = 0; k < 2000; ++k) ASSERT_EQ(go({.ending = true}), DeviceState::kRetracting) << k;
}

}  // namespace
}  // namespace softfinger
