#include "softfinger/actuation/guard_silence.hpp"

#include <gtest/gtest.h>

namespace softfinger {
namespace {

constexpr double kBeat = 3.0;

TEST(GuardSilence, GoesOnFromHalfOfWhatIsTooLong) {
  GuardSilence silence;
  EXPECT_FALSE(silence.goes_on(kBeat, 1.0)) << "nobody has looked at that beat before";
  silence.begin(kBeat, 0.0);
  EXPECT_FALSE(silence.goes_on(kBeat, 0.0449));
  EXPECT_TRUE(silence.goes_on(kBeat, 0.0451));
  EXPECT_TRUE(silence.goes_on(kBeat, 0.5 * GuardSilence::kLongest));
  EXPECT_FALSE(silence.goes_on(kBeat + 0.02, 1.0));
}

/// The first of these looks, 10 ms apart, at which it hangs; 0: at none of them.
int look_that_tells(GuardSilence& silence, ProcessState state, double from, int looks,
                    double processor_time = 0.0) {
  for (int look = 1; look <= looks; ++look) {
    if (silence.hangs(from + 0.01 * (look - 1), state, processor_time)) return look;
  }
  return 0;
}

TEST(GuardSilence, OneThatSleepsOrIsStoppedHangsAfterNinetyMillisecondsAndFourLooks) {
  for (const ProcessState state :
       {ProcessState::kAsleep, ProcessState::kStopped, ProcessState::kGone}) {
    GuardSilence early;
    early.begin(kBeat, 0.0);
    EXPECT_EQ(look_that_tells(early, state, 0.0501, 20), 5) << "at 90 ms";
    GuardSilence late;
    late.begin(kBeat, 0.0);
    EXPECT_EQ(look_that_tells(late, state, 0.2, 20), 4);
    late.begin(kBeat + 0.02, 0.0);
    EXPECT_EQ(look_that_tells(late, state, 0.2, 20), 4) << "looks before do not count";
  }
}

TEST(GuardSilence, OneInADriverHangsAfterAQuarterOfASecondAndTenLooks) {
  GuardSilence early;
  early.begin(kBeat, 0.0);
  EXPECT_EQ(look_that_tells(early, ProcessState::kInDriver, 0.0501, 40), 21) << "at 250 ms";
  GuardSilence late;
  late.begin(kBeat, 0.0);
  EXPECT_EQ(look_that_tells(late, ProcessState::kInDriver, 1.0, 40), 10);
  late.begin(kBeat + 0.02, 0.0);
  EXPECT_EQ(look_that_tells(late, ProcessState::kInDriver, 1.0, 40), 10);
}

// It sleeps between its commands: that says nothing as long as it beats, however long one looks.
TEST(GuardSilence, BeginsWithTheFirstLookThatFindsItSilent) {
  GuardSilence silence;
  const auto asleep = [](double beat) {
    return [beat] { return GuardSilence::Seen{beat, ProcessState::kAsleep}; };
  };
  for (int look = 0; look < 100; ++look) {
    EXPECT_FALSE(silence.tells_that_it_hangs(look, 0.01, 0.0, asleep(look))) << look;
  }
  // Guard and watcher were held for a second, both of them.
  constexpr double kLast = 1000.0;
  for (int look = 0; look < GuardSilence::kLooksAsleep; ++look) {
    EXPECT_FALSE(silence.tells_that_it_hangs(kLast, 1.0, 0.0, asleep(kLast))) << look;
  }
  EXPECT_TRUE(silence.tells_that_it_hangs(kLast, 1.0, 0.0, asleep(kLast)));
}

TEST(GuardSilence, OneThatBeatsWhileItIsLookedAtDoesNotHang) {
  GuardSilence silence;
  const auto woken = [] { return GuardSilence::Seen{kBeat + 0.01, ProcessState::kAsleep}; };
  for (int look = 0; look < 20; ++look) {
    EXPECT_FALSE(silence.tells_that_it_hangs(kBeat, 1.0, 0.0, woken)) << look;
  }
}

// What it used of a processor before it fell silent is none of its silence.
TEST(GuardSilence, CountsProcessorTimeFromItsBegin) {
  GuardSilence silence;
  const auto runs = [] { return GuardSilence::Seen{kBeat, ProcessState::kRunning}; };
  EXPECT_FALSE(silence.tells_that_it_hangs(kBeat, 1.0, 50.0, runs));
  EXPECT_FALSE(silence.tells_that_it_hangs(kBeat, 1.0, 50.0, runs));
  EXPECT_TRUE(silence.tells_that_it_hangs(kBeat, 1.0, 50.0 + GuardSilence::kSpinning, runs));
}

TEST(GuardSilence, ItsBoundsAreTooLong) {
  GuardSilence silence;
  silence.begin(kBeat, 0.0);
  EXPECT_TRUE(
      silence.hangs(GuardSilence::kLongest, ProcessState::kRunning, GuardSilence::kSpinning));
  EXPECT_EQ(look_that_tells(silence, ProcessState::kAsleep, GuardSilence::kLongest, 4), 4);
  for (int look = 1; look < GuardSilence::kLooksInDriver; ++look) {
    EXPECT_FALSE(silence.hangs(GuardSilence::kInDriver, ProcessState::kInDriver, 0.0));
  }
  EXPECT_TRUE(silence.hangs(GuardSilence::kInDriver, ProcessState::kInDriver, 0.0));
}

TEST(GuardSilence, OneThatRunsHangsOnlyByWhatItUsesOfAProcessor) {
  GuardSilence silence;
  silence.begin(kBeat, 5.0);
  EXPECT_EQ(look_that_tells(silence, ProcessState::kRunning, 10.0, 100, 5.069), 0)
      << "it waits for a processor";
  EXPECT_EQ(look_that_tells(silence, ProcessState::kRunning, 0.0501, 20, 5.0701), 5) << "it spins";
}

// Two kinds of looks do not add up.
TEST(GuardSilence, LooksOfOneKindDoNotCountForTheOther) {
  GuardSilence silence;
  silence.begin(kBeat, 0.0);
  for (int look = 0; look < 3; ++look) {
    EXPECT_FALSE(silence.hangs(0.2, ProcessState::kAsleep, 0.0));
    EXPECT_FALSE(silence.hangs(0.2, ProcessState::kInDriver, 0.0));
  }
  EXPECT_TRUE(silence.hangs(0.2, ProcessState::kAsleep, 0.0));
}

}  // namespace
}  // namespace softfinger
