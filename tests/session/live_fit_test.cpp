// A fit of a device to its wearer, asked for from the page: the presses, the file, the device that
// stays away, and the run that goes on with what was found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "../support/scenes_without_force_limit.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/session/live_session.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;
constexpr auto kLongest = std::chrono::seconds(90);
constexpr int kAttempts = 5;

/// A live run of a thimble with a force sensor on somebody else's finger, and its viewer, which is
/// this thread.
class FittingSession : public testing::Test {
 protected:
  void begin(const std::string& sensor) {
    std::ofstream(scenes_.device("thimble-3rrs"), std::ios::app) << sensor;
    RunOptions options;
    options.scene = scenes_.scene("sphere");
    options.twin = false;
    options.person = person_;
    options.person_may_be_new = true;
    options.wearer = "middle";
    session_ = std::make_unique<LiveSession>(options, true);
    loop_ = std::thread([this] {
      session_->run(stop_, {.message = [this](const std::string&) { ++told_; }, .progress = {}});
    });
  }
  ~FittingSession() override {
    stop_ = true;
    if (loop_.joinable()) loop_.join();
  }

  void ask(LiveRequest::Kind kind) {
    LiveRequest request;
    request.kind = kind;
    request.generation = session_->latest().generation;
    request.stops = session_->latest().stops;
    session_->request(request);
  }
  template <typename Reached>
  bool watch(const Reached& reached) {
    const auto end = std::chrono::steady_clock::now() + kLongest;
    while (!reached()) {
      if (std::chrono::steady_clock::now() > end) return false;
      session_->refresh();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
  }
  [[nodiscard]] FitState::Phase phase() { return session_->fit().phase; }
  /// Asks for a fit, and waits until the session has heard it.
  bool fit() {
    ask(LiveRequest::Kind::kCancelFit);  // what is told of one before
    ask(LiveRequest::Kind::kFit);
    return watch([&] { return phase() != FitState::Phase::kIdle; });
  }
  [[nodiscard]] bool under_way() { return session_->fit().is_under_way(); }
  /// The run of this generation, which has begun.
  bool comes_back(int generation) {
    return watch([&] {
      const Snapshot& now = session_->latest();
      return now.generation == static_cast<std::uint64_t>(generation) && now.time > 0.05;
    });
  }
  bool comes_back_stopped() {
    return comes_back(2) && watch([&] {
             const Snapshot& now = session_->latest();
             return now.stopped.asked && now.fingers.at(0).device_state == "retracting";
           });
  }
  bool is_released() {
    return watch([&] {
      ask(LiveRequest::Kind::kRelease);
      return !session_->latest().stopped.asked;
    });
  }

  const ScenesWithoutForceLimit scenes_;
  const TemporaryDirectory directory_;
  const std::filesystem::path person_ = directory_ / "anna.toml";
  std::atomic<bool> stop_{false};
  std::atomic<int> told_{0};
  std::unique_ptr<LiveSession> session_;
  std::thread loop_;
};

constexpr const char* kSensor = "\n[force_sensor]\nkind = \"emulator\"\nnoise_N = 0.02\n";

/// All presses of it take 16 s without a pause of a tenth: nothing else runs beside it.
class WholeFitInRealTime : public FittingSession {};

TEST_F(WholeFitInRealTime, LearnsTheWearerAndGoesOnWithItRetracted) {
#ifdef SOFTFINGER_SANITIZED
  GTEST_SKIP() << "the emulated wearer is too slow for the clock under a sanitizer";
#endif
  begin(kSensor);
  ASSERT_TRUE(session_->description()->fingers.at(0).fittable);
  double most = 0.0;
  // A machine that is too busy to command a device in time ends it, and may be asked again.
  for (int attempt = 0; attempt < kAttempts && phase() != FitState::Phase::kSaved; ++attempt) {
    ASSERT_TRUE(comes_back(attempt + 1));
    ASSERT_TRUE(fit());
    ASSERT_TRUE(watch([&] { return session_->fit().press > 1 || !under_way(); }));
    ask(LiveRequest::Kind::kRelease);  // not while it presses by itself
    EXPECT_TRUE(watch([&] {
      return session_->take_message() == "the device is not released: it learns its wearer" ||
             !under_way();
    }));
    EXPECT_TRUE(under_way() || phase() == FitState::Phase::kRefused);
    ASSERT_TRUE(watch([&] {
      most = std::max(most, session_->fit().force);
      return !under_way();
    }));
    const std::string message = session_->fit().message;
    if (phase() == FitState::Phase::kSaved) {
      EXPECT_THAT(message, HasSubstr("mm long"));
    } else {
      ASSERT_THAT(message, HasSubstr("no command for"));
    }
    ASSERT_TRUE(comes_back(attempt + 2));
    EXPECT_TRUE(session_->latest().stopped.asked);
  }
  ASSERT_EQ(phase(), FitState::Phase::kSaved);
  EXPECT_GE(session_->fit().presses, 9);
  EXPECT_LE(session_->fit().presses, 10);  // straight on once more where there was time
  EXPECT_GT(most, 0.5);
  EXPECT_LT(most, 1.1);
  const Person found = load_person(person_);
  ASSERT_NE(found.find("index"), nullptr);
  EXPECT_TRUE(found.find("index")->mount);
  EXPECT_TRUE(found.find("index")->modulus_factor);
  EXPECT_TRUE(is_released());
}

TEST_F(FittingSession, AStopEndsItAndNothingIsWritten) {
  begin(kSensor);
  ASSERT_TRUE(comes_back(1));
  ASSERT_TRUE(fit());
  ASSERT_TRUE(watch([&] { return session_->fit().force > 0.2 || !under_way(); }));
  ask(LiveRequest::Kind::kStop);
  ASSERT_TRUE(watch([&] { return !under_way(); }));
  EXPECT_EQ(phase(), FitState::Phase::kRefused);
  EXPECT_FALSE(std::filesystem::exists(person_));
  ASSERT_TRUE(comes_back_stopped());
  ask(LiveRequest::Kind::kCancelFit);
  EXPECT_EQ(phase(), FitState::Phase::kIdle);
  EXPECT_TRUE(is_released());
}

TEST_F(FittingSession, AStopBeforeItBeginsIsOneToo) {
  begin(kSensor);
  ASSERT_TRUE(comes_back(1));
  ASSERT_TRUE(fit());
  ask(LiveRequest::Kind::kStop);
  ASSERT_TRUE(watch([&] { return !under_way(); }));
  EXPECT_EQ(phase(), FitState::Phase::kRefused);
  EXPECT_EQ(session_->fit().press, 0);
}

TEST_F(FittingSession, WithoutASensorItGoesByTouch) {
#ifdef SOFTFINGER_SANITIZED
  GTEST_SKIP() << "the emulated wearer is too slow for the clock under a sanitizer";
#endif
  begin("");
  EXPECT_TRUE(session_->description()->fingers.at(0).fittable);
  EXPECT_TRUE(session_->description()->fingers.at(0).fits_by_touch);
  int attempt = 0;
  do {
    // A machine that is too busy to command a device in time ends it, and may be asked again.
    if (attempt > 0) {
      ASSERT_THAT(session_->fit().message, HasSubstr("no command for"));
    }
    ASSERT_TRUE(comes_back(attempt + 1));
    ASSERT_TRUE(fit());
    // The emulated wearer tells by itself, and a word of somebody else is not heard.
    ASSERT_TRUE(watch([&] {
      ask(LiveRequest::Kind::kFelt);
      return session_->fit().press > 1 || !under_way();
    }));
  } while (!under_way() && ++attempt < kAttempts);
  ASSERT_TRUE(under_way()) << session_->fit().message;
  EXPECT_TRUE(session_->fit().by_touch);
  EXPECT_EQ(session_->fit().presses, 10);
  EXPECT_THAT(session_->fit().words, HasSubstr("as soon as you feel"));
  ask(LiveRequest::Kind::kCancelFit);
  ASSERT_TRUE(watch([&] { return !under_way(); }));
  EXPECT_EQ(phase(), FitState::Phase::kRefused);
  EXPECT_FALSE(std::filesystem::exists(person_));
  EXPECT_TRUE(comes_back(attempt + 2));
  EXPECT_TRUE(watch([&] { return session_->latest().stopped.asked; }));
}

}  // namespace
}  // namespace softfinger
