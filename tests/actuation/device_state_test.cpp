#include "softfinger/actuation/device_state.hpp"

#include <gtest/gtest.h>

namespace softfinger {
namespace {

constexpr double kPeriod = 1.0 / 30.0;

TEST(DeviceState, HomesThenFollows) {
  DeviceStateMachine machine;
  EXPECT_EQ(machine.advance({.time = 0.0, .arrived = false}), DeviceState::kHoming);
  EXPECT_EQ(machine.advance({.time = kPeriod, .arrived = false}), DeviceState::kHoming);
  EXPECT_EQ(machine.advance({.time = 2 * kPeriod, .arrived = true}), DeviceState::kReady);
  EXPECT_EQ(machine.advance({.time = 3 * kPeriod, .touching = true, .arrived = false}),
            DeviceState::kRendering);
  EXPECT_EQ(machine.advance({.time = 4 * kPeriod, .arrived = true}), DeviceState::kReady);
}

TEST(DeviceState, LostTrackingHoldsThenRetractsThenHomes) {
  DeviceStateMachine machine;
  machine.advance({.time = 0.0, .arrived = true});
  int k = 1;
  for (; k * kPeriod < 0.2 + kPeriod - 1e-6; ++k) {
    EXPECT_EQ(machine.advance({.time = k * kPeriod, .tracked = false, .arrived = true}),
              DeviceState::kHolding)
        << k;
  }
  EXPECT_EQ(machine.advance({.time = k * kPeriod, .tracked = false}), DeviceState::kRetracting);
  ++k;
  EXPECT_EQ(machine.advance({.time = k * kPeriod, .arrived = true}), DeviceState::kHoming);
  ++k;
  EXPECT_EQ(machine.advance({.time = k * kPeriod, .arrived = true}), DeviceState::kReady);
}

TEST(DeviceState, EmergencyStopRetractsAtOnceUntilItIsReleased) {
  DeviceStateMachine machine;
  machine.advance({.time = 0.0, .touching = true, .arrived = true});
  machine.advance({.time = kPeriod, .touching = true, .arrived = true});
  int k = 2;
  for (; k < 40; ++k) {
    EXPECT_EQ(machine.advance(
                  {.time = k * kPeriod, .touching = true, .emergency = true, .arrived = k > 10}),
              DeviceState::kRetracting)
        << k;
  }
  EXPECT_EQ(machine.advance({.time = k * kPeriod, .touching = true, .arrived = true}),
            DeviceState::kHoming);
  EXPECT_EQ(machine.advance({.time = (k + 1) * kPeriod, .touching = true, .arrived = true}),
            DeviceState::kRendering);
}

TEST(DeviceState, EndRepeatsTheRetractedPoseFor300Milliseconds) {
  DeviceStateMachine machine;
  machine.advance({.time = 0.0, .arrived = true});
  EXPECT_EQ(machine.advance({.time = 1 * kPeriod, .ending = true}), DeviceState::kRetracting);
  EXPECT_EQ(machine.advance({.time = 2 * kPeriod, .ending = true}), DeviceState::kRetracting);
  // The command of tick 2 was the retracted pose: ticks up to 2 + 9 repeat it.
  for (int k = 3; k <= 11; ++k) {
    EXPECT_EQ(machine.advance({.time = k * kPeriod, .ending = true, .arrived = true}),
              DeviceState::kRetracting)
        << k;
  }
  EXPECT_EQ(machine.advance({.time = 12 * kPeriod, .ending = true, .arrived = true}),
            DeviceState::kStopped);
  EXPECT_EQ(machine.advance({.time = 13 * kPeriod, .arrived = true}), DeviceState::kStopped);
}

// Whatever keeps it from arriving: a program must end.
TEST(DeviceState, GivesUpARetractionThatDoesNotArrive) {
  DeviceStateMachine machine;
  machine.advance({.time = 0.0, .arrived = true});
  double time = kPeriod;
  while (machine.advance({.time = time, .ending = true}) == DeviceState::kRetracting) {
    time += kPeriod;
    ASSERT_LT(time, kLongestRetraction + 1.0);
  }
  EXPECT_EQ(machine.state(), DeviceState::kStopped);
  EXPECT_GT(time, kLongestRetraction);
}

TEST(DeviceState, EachHasARowAndAShortNameOfItsOwn) {
  for (int i = 0; i <= static_cast<int>(DeviceState::kStopped); ++i) {
    const auto state = static_cast<DeviceState>(i);
    EXPECT_EQ(row_of(kDeviceStates, state).value, state);
    const std::string_view name = state_name(state);
    EXPECT_FALSE(name.empty());
    EXPECT_LE(name.size(), 15u);
    ASSERT_NE(row_named(kDeviceStates, name), nullptr);
    EXPECT_EQ(row_named(kDeviceStates, name)->value, state);
  }
  EXPECT_EQ(row_named(kDeviceStates, "asleep"), nullptr);
}

}  // namespace
}  // namespace softfinger
