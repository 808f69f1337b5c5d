#include "softfinger/world/world_events.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "play.hpp"

namespace softfinger {
namespace {

using Kind = EventKind;

/// Two objects that move, 0 and 2, one between them that does not, and a finger, 3.
class ToldEvents {
 public:
  explicit ToldEvents(std::vector<WorldEvents::Joint> joints = {}, double time_step = 1e-3)
      : time_step_(time_step),
        joints_(std::move(joints)),
        events_(kMoving, 3, 1, joints_, time_step) {}
  /// `say` by the number of the step, from 1.
  void run(int steps, const std::function<void(WorldEvents&, int)>& say) {
    for (int k = 0; k < steps; ++k) {
      say(events_, ++step_);
      events_.end_step();
      take();
    }
  }
  void finish() {
    events_.finish();
    take();
  }
  std::vector<WorldEvent> all;

 private:
  static constexpr std::array<int, 2> kMoving{0, 2};
  void take() {
    for (const WorldEvent& event : events_.told()) {
      // In order, and not before they are known.
      EXPECT_GE(event.time, all.empty() ? 0.0 : all.back().time);
      EXPECT_LE(event.time, step_ * time_step_ + 1e-12);
      all.push_back(event);
    }
  }
  double time_step_;
  std::vector<WorldEvents::Joint> joints_;
  WorldEvents events_;
  int step_ = 0;
};

void expect_event(const WorldEvent& event, double time, Kind kind, int object, int other) {
  EXPECT_NEAR(event.time, time, 1e-12);
  EXPECT_STREQ(event_name(event.kind), event_name(kind));
  EXPECT_EQ(event.object, object);
  EXPECT_EQ(event.other, other);
}

TEST(WorldEvents, AnImpactHasTheImpulseOfItsFirstTenMilliseconds) {
  ToldEvents told;
  told.run(200, [](WorldEvents& events, int step) {
    if (step < 50 || step >= 100) return;
    events.touch(2, 1, 1.5);  // by two of their points, either way round
    events.touch(1, 2, 0.5);
  });
  ASSERT_EQ(told.all.size(), 2U);
  expect_event(told.all[0], 0.050, Kind::kImpact, 1, 2);
  EXPECT_NEAR(told.all[0].impulse, 2.0 * 0.010, 1e-15);
  expect_event(told.all[1], 0.119, Kind::kRelease, 1, 2);
  EXPECT_TRUE(std::isnan(told.all[1].impulse));
}

TEST(WorldEvents, WhatChattersIsOneImpact) {
  ToldEvents told;
  told.run(200, [](WorldEvents& events, int step) {
    if (step >= 30 && step <= 90 && step % 19 == 0) events.touch(0, 3, 1.0);
  });
  ASSERT_EQ(told.all.size(), 2U);
  expect_event(told.all[0], 0.038, Kind::kImpact, 0, 3);
  EXPECT_NEAR(told.all[0].impulse, 1e-3, 1e-15);
  expect_event(told.all[1], 0.096, Kind::kRelease, 0, 3);
}

TEST(WorldEvents, WhatRestsFromTheStartDidNotComeThere) {
  ToldEvents told;
  told.run(100, [](WorldEvents& events, int step) {
    events.touch(0, 1, 1.0);
    if (step >= 10) events.touch(0, 2, 1.0);  // this one came
  });
  ASSERT_EQ(told.all.size(), 1U);
  expect_event(told.all[0], 0.010, Kind::kImpact, 0, 2);
}

TEST(WorldEvents, AreTheSameAtAnyRate) {
  for (const double h : {1e-3, 0.25e-3}) {
    ToldEvents told({}, h);
    told.run(static_cast<int>(std::lround(0.2 / h)), [h](WorldEvents& events, int step) {
      const double time = step * h;
      if (time > 0.0501 && time < 0.0999) events.touch(0, 2, 3.0);
    });
    ASSERT_EQ(told.all.size(), 2U);
    EXPECT_NEAR(told.all[0].time, 0.050, 1.01e-3);
    EXPECT_NEAR(told.all[0].impulse, 0.030, 1e-12);
    EXPECT_NEAR(told.all[1].time, 0.120, 1.01e-3);
  }
}

TEST(WorldEvents, AButtonClicksInwardsAndOutwards) {
  const std::vector<ForceCurve::Snap> snaps{{1e-3, 1.4e-3}};
  ToldEvents told({{.object = 2, .mass = 0.01, .snaps = snaps}});
  double q = 0.0;
  const auto slide = [&](double way) {
    return [&q, way](WorldEvents& events, int) {
      // It is quicker on its way between top and valley.
      q += (-q > 0.99e-3 && -q < 1.45e-3 ? 3.0 : 1.0) * way;
      events.joint(0, {.q = q});
    };
  };
  told.run(30, slide(-0.0499e-3));  // past the top in the 21st step, past the valley in the 23rd
  told.run(30, slide(0.0499e-3));
  told.run(40, [&](WorldEvents& events, int) { events.joint(0, {.q = q}); });
  ASSERT_EQ(told.all.size(), 2U);
  expect_event(told.all[0], 0.021, Kind::kClick, 2, -1);
  EXPECT_NEAR(told.all[0].impulse, 2.0 * 0.01 * 0.0499, 1e-9);
  expect_event(told.all[1], 0.040, Kind::kClick, 2, -1);
  EXPECT_NEAR(told.all[1].impulse, 2.0 * 0.01 * 0.0499, 1e-9);
}

TEST(WorldEvents, AClickThatStopsHalfWayHasNoImpulse) {
  const std::vector<ForceCurve::Snap> snaps{{1e-3, 1.4e-3}};
  ToldEvents told({{.object = 0, .mass = 0.01, .snaps = snaps}});
  told.run(50, [&](WorldEvents& events, int step) {
    events.joint(0, {.q = step < 10 ? 0.0 : -1.2e-3});
  });
  ASSERT_EQ(told.all.size(), 1U);
  EXPECT_TRUE(std::isnan(told.all[0].impulse));
}

TEST(WorldEvents, AKnobTellsItsDetentsAndAJointItsLimit) {
  ToldEvents told({{.object = 0}, {.object = 2, .mass = 0.01}});
  told.run(100, [](WorldEvents& events, int step) {
    events.joint(0, {.limit_force = step >= 40 ? 0.1 : 0.0, .detent = step / 15});
    events.joint(1, {.limit_force = step >= 40 && step < 43 ? -2.0 : 0.0});
  });
  ASSERT_EQ(told.all.size(), 8U);
  for (int k = 1; k <= 2; ++k) {
    expect_event(told.all[static_cast<std::size_t>(k - 1)], 0.015 * k, Kind::kDetent, 0, -1);
  }
  expect_event(told.all[2], 0.040, Kind::kLimit, 0, -1);
  EXPECT_TRUE(std::isnan(told.all[2].impulse)) << "a hinge's would be another unit";
  expect_event(told.all[3], 0.040, Kind::kLimit, 2, -1);
  EXPECT_NEAR(told.all[3].impulse, 6e-3, 1e-15);
}

TEST(WorldEvents, AJointThatRestsAtItsLimitByRoundingAloneHasNotMetIt) {
  ToldEvents told({{.object = 2, .mass = 0.3}});
  told.run(100, [](WorldEvents& events, int step) {
    events.joint(0, {.limit_force = step % 30 == 0 ? 1e-12 : 0.0});
  });
  EXPECT_TRUE(told.all.empty());
}

TEST(WorldEvents, AFallenBallTellsItsImpact) {
  const double mass = 0.02, height = 5e-3;
  Play play({still("ground", HalfSpace{}), loose("ball", Ball{0.01}, {0, 0, 0.01 + height}, mass)});
  play.run(0.2);
  ASSERT_EQ(play.events().size(), 1U);
  const double fall = std::sqrt(2.0 * height / kGravity);
  EXPECT_NEAR(play.events()[0].time, fall, 2e-3);
  EXPECT_EQ(play.events()[0].object, 0);
  EXPECT_EQ(play.events()[0].other, 1);
  // All its momentum, and its weight for ten milliseconds.
  const double impulse = mass * kGravity * (fall + 0.01);
  EXPECT_NEAR(play.events()[0].impulse, impulse, 0.05 * impulse);
}

TEST(WorldEvents, AButtonUnderAWeightClicksOnceAndMeetsItsLimit) {
  VirtualObject button = loose("button", RoundedCylinder{5e-3, 2e-3, 0.5e-3}, {0, 0, 0}, 0.01);
  button.dynamics->joint =
      Joint{.kind = JointKind::kSlider,
            .limits = std::array{-2.5e-3, 0.0},
            .damping = 0.5,
            .curve = JointCurve{{0.0, 1e-3, 1.4e-3, 2.5e-3}, {0.0, 1.2, 0.7, 1.1}}};
  Play play({button}, Vector3(0, 0, -1.3 / 0.01));
  play.run(0.3);
  ASSERT_GE(play.events().size(), 2U);
  expect_event(play.events()[0], play.events()[0].time, Kind::kClick, 0, -1);
  EXPECT_GT(play.events()[0].impulse, 0.0);
  expect_event(play.events()[1], play.events()[1].time, Kind::kLimit, 0, -1);
  EXPECT_GT(play.events()[1].impulse, 0.0);
  EXPECT_NEAR(play.state(0).joint, -2.5e-3, 5e-6);
  EXPECT_LE(play.events().size(), 3U);
}

TEST(WorldEvents, AnEndTellsWhatIsOpen) {
  ToldEvents told;
  told.run(25, [](WorldEvents& events, int step) {
    if (step > 20) events.touch(0, 2, 1.0);
  });
  EXPECT_TRUE(told.all.empty());
  told.finish();
  ASSERT_EQ(told.all.size(), 1U);
  EXPECT_NEAR(told.all[0].impulse, 5e-3, 1e-15);
}

}  // namespace
}  // namespace softfinger
