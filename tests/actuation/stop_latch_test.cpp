#include "softfinger/actuation/stop_latch.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace softfinger {
namespace {

TEST(StopLatch, IsFreeUntilSomebodyStopsIt) {
  StopLatch latch;
  EXPECT_FALSE(latch.is_stopped());
  EXPECT_FALSE(latch.ask_release(0));
  EXPECT_FALSE(latch.release_is_asked());
  EXPECT_EQ(latch.stop(StopCause::kPerson), 1U);
  EXPECT_TRUE(latch.is_stopped());
  EXPECT_EQ(latch.cause(), StopCause::kPerson);
}

TEST(StopLatch, StopsAreAFactOnlyWhenTheLeaderSaysSo) {
  StopLatch latch;
  const auto number = latch.stop(StopCause::kSignal);
  EXPECT_NE(latch.confirmed(), number);
  latch.confirm(number);
  EXPECT_EQ(latch.confirmed(), number);
}

TEST(StopLatch, AReleaseIsARequestThatTheLeaderGrants) {
  StopLatch latch;
  const auto number = latch.stop(StopCause::kPerson);
  EXPECT_TRUE(latch.ask_release(number));
  EXPECT_TRUE(latch.is_stopped()) << "nobody has granted it";
  EXPECT_TRUE(latch.release_is_asked());
  latch.answer_release(ReleaseRefusal::kServoFault);
  EXPECT_TRUE(latch.is_stopped());
  EXPECT_FALSE(latch.release_is_asked());
  EXPECT_EQ(latch.refusals(), 1U);
  EXPECT_EQ(latch.refusal(), ReleaseRefusal::kServoFault);
  EXPECT_TRUE(latch.ask_release(number));
  latch.answer_release(ReleaseRefusal::kNone);
  EXPECT_FALSE(latch.is_stopped());
  EXPECT_EQ(latch.released(), number);
  EXPECT_EQ(latch.refusals(), 1U);
}

TEST(StopLatch, ALateReleaseIsNothingAgainstALaterStop) {
  StopLatch latch;
  const auto first = latch.stop(StopCause::kPerson);
  const auto second = latch.stop(StopCause::kPerson);
  EXPECT_FALSE(latch.ask_release(first));
  EXPECT_TRUE(latch.ask_release(second));
  latch.answer_release(ReleaseRefusal::kNone);
  EXPECT_FALSE(latch.is_stopped());
  EXPECT_FALSE(latch.ask_release(second)) << "it has ended";
  const auto third = latch.stop(StopCause::kServo);
  EXPECT_FALSE(latch.ask_release(second)) << "pressed once more, too late";
  EXPECT_TRUE(latch.is_stopped());
  EXPECT_TRUE(latch.ask_release(third));
}

TEST(StopLatch, AStopBetweenAskingAndGrantingStays) {
  StopLatch latch;
  ASSERT_TRUE(latch.ask_release(latch.stop(StopCause::kPerson)));
  latch.stop(StopCause::kSignal);
  EXPECT_FALSE(latch.release_is_asked());
  latch.answer_release(ReleaseRefusal::kNone);
  EXPECT_TRUE(latch.is_stopped());
}

TEST(StopLatch, AnAnswerToNobodyIsNone) {
  StopLatch latch;
  latch.stop(StopCause::kPerson);
  latch.answer_release(ReleaseRefusal::kNone);
  latch.answer_release(ReleaseRefusal::kPortClosed);
  EXPECT_TRUE(latch.is_stopped());
  EXPECT_EQ(latch.refusals(), 0U);
}

// Whatever the interleaving: after the last stop, which nobody releases, it is stopped.
TEST(StopLatch, ManyThreadsNeverLoseAStop) {
  for (int round = 0; round < 200; ++round) {
    StopLatch latch;
    std::atomic<bool> stopping{true};
    std::thread leader([&] {
      while (stopping) latch.answer_release(ReleaseRefusal::kNone);
    });
    std::thread releaser([&] {
      while (stopping) latch.ask_release(latch.released() + 1);
    });
    std::vector<std::thread> people;
    for (int k = 0; k < 3; ++k) {
      people.emplace_back([&] {
        for (int i = 0; i < 20; ++i) latch.stop(StopCause::kPerson);
      });
    }
    for (std::thread& person : people) person.join();
    stopping = false;
    leader.join();
    releaser.join();
    const auto last = latch.stop(StopCause::kPerson);
    EXPECT_EQ(last, 61U);
    latch.answer_release(ReleaseRefusal::kNone);
    EXPECT_TRUE(latch.is_stopped());
  }
}

}  // namespace
}  // namespace softfinger
