#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../support/scenes_without_force_limit.hpp"
#include "../support/temporary_directory.hpp"
#include "recorded_run.hpp"
#include "softfinger/objectives/objective_kinds.hpp"
#include "softfinger/session/replay.hpp"

namespace softfinger {
namespace {

TEST(LiveRun, ReplaysToTheBit) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.duration = 2.5;
  options.recording = directory / "live.db";
  LiveSession session(options, false);
  const std::atomic<bool> stop{false};
  const RunSummary summary = session.run(stop);
  EXPECT_EQ(summary.steps, 2500);
  EXPECT_TRUE(summary.deadline_misses.has_value());
  EXPECT_TRUE(RecordingReader(directory / "live.db").info().live);
  const ReplayResult result = replay({.recording = directory / "live.db", .scene = {}});
  EXPECT_TRUE(result.agree) << *result.first_difference << " " << result.difference;
}

TEST(LiveRun, PausesRestartsAndChangesScene) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.recording = directory / "live.db";
  LiveSession session(options, false);
  EXPECT_THAT(session.description()->scene_names,
              testing::IsSupersetOf({"edge", "plane", "sphere"}));
  std::atomic<bool> stop{false};
  std::thread viewer([&] {
    const auto wait = [&](const auto& condition) {
      for (int i = 0; i < 6000; ++i) {  // a minute: sanitizers are slow
        session.refresh();
        if (condition(session.latest())) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      return false;
    };
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.step > 300; }));
    session.request({LiveRequest::Kind::kPause, ""});
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.paused; }));
    const std::uint64_t step = session.latest().step;
    // Under a sanitizer no machine keeps up, and the device has retracted before.
    const bool kept_up = session.latest().fingers.at(0).device_state != "retracting";
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    session.refresh();
    EXPECT_EQ(session.latest().step, step);
    // A pause is no stall: the device holds.
    EXPECT_TRUE(!kept_up || session.latest().fingers.at(0).device_state != "retracting");
    session.request({LiveRequest::Kind::kResume, ""});
    EXPECT_TRUE(wait([&](const Snapshot& s) { return s.step > step + 300; }));
    session.request({LiveRequest::Kind::kScene, "no such scene"});
    session.request({LiveRequest::Kind::kScene, "edge"});
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.generation == 2 && s.step > 100; }));
    EXPECT_EQ(session.description()->scene_name, "edge");
    stop = true;
  });
  session.run(stop);
  viewer.join();
  const ReplayResult paused = replay({.recording = directory / "live.db", .scene = {}});
  EXPECT_TRUE(paused.agree) << *paused.first_difference << " " << paused.difference;
  EXPECT_TRUE(replay({.recording = directory / "live-2.db", .scene = {}}).agree);
}

// The page changes what leads the device: from one tick on, in a pause too, and a replay does the
// same at the same tick. It outlasts a restart, not another scene.
TEST(LiveRun, AnObjectiveChangesWhileItRunsAndReplaysToTheBit) {
  const ScenesWithoutForceLimit scenes;
  const TemporaryDirectory directory;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.recording = directory / "live.db";
  options.twin = false;
  LiveSession session(options, false);
  std::atomic<bool> stop{false};
  const auto number = [](const char* name) {
    return static_cast<int>(number_of(*objective_kind(name)));
  };
  const int own = static_cast<int>(number_of(objective_kind(*load_setup(options)->devices[0])));
  std::thread viewer([&] {
    const auto wait = [&](const auto& condition) {
      for (int i = 0; i < 6000; ++i) {
        session.refresh();
        if (condition(session.latest())) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      return false;
    };
    const auto ask = [&](const std::string& objective, std::size_t finger = 0) {
      LiveRequest request;
      request.kind = LiveRequest::Kind::kObjective;
      request.finger = finger;
      request.objective = objective;
      session.request(request);
    };
    const auto led_by = [](int objective) {
      return [=](const Snapshot& s) {
        return s.fingers[0].tick >= 0 && s.fingers[0].objective == objective;
      };
    };
    const std::vector<int>& choice = session.description()->fingers[0].objectives;
    EXPECT_EQ(choice.size(), session.description()->objectives.size());
    EXPECT_TRUE(wait(led_by(own)));
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.fingers[0].contact_count > 3; }));
    for (const char* objective : {"stress", "plane", "published"}) {
      ask(objective);
      EXPECT_TRUE(wait(led_by(number(objective)))) << objective;
    }
    ask("fun");
    ask("plane", 7);
    session.request({LiveRequest::Kind::kPause, ""});
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.paused; }));
    ask("plane");
    EXPECT_TRUE(wait(led_by(number("plane"))));
    session.request({LiveRequest::Kind::kResume, ""});
    session.request({LiveRequest::Kind::kRestart, ""});
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.generation == 2 && s.step > 200; }));
    EXPECT_TRUE(wait(led_by(number("plane"))));
    session.request({LiveRequest::Kind::kScene, "plane"});
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.generation == 3 && s.step > 200; }));
    EXPECT_TRUE(wait(led_by(own)));
    stop = true;
  });
  session.run(stop);
  viewer.join();
  std::vector<double> led;
  for (const TickRecord& tick : ticks_of(directory / "live.db")) {
    if (led.empty() || led.back() != tick.objective) led.push_back(tick.objective);
  }
  EXPECT_THAT(led, testing::ElementsAre(own, number("stress"), number("plane"), number("published"),
                                        number("plane")));
  for (const char* recording : {"live.db", "live-2.db"}) {
    const ReplayResult result = replay({.recording = directory / recording, .scene = {}});
    EXPECT_TRUE(result.agree) << recording << ": " << *result.first_difference << " "
                              << result.difference;
  }
}

TEST(LiveRun, TrackingThatIsLostInAPauseRetractsTheDevice) {
  const ScenesWithoutForceLimit scenes;
  RunOptions options;
  options.scene = scenes.scene("plane");
  options.trackers = {"page"};
  options.twin = false;
  LiveSession session(options, false);
  std::atomic<bool> stop{false};
  std::thread viewer([&] {
    bool seen = true;  // the finger, by the page
    const auto wait = [&](const auto& condition) {
      for (int i = 0; i < 6000; ++i) {
        LiveRequest pose;
        pose.kind = LiveRequest::Kind::kPose;
        pose.X_W.translation.z() = 20e-3;
        if (seen) session.request(pose);
        session.refresh();
        if (condition(session.latest())) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      return false;
    };
    const auto state = [](const Snapshot& s) { return s.fingers.at(0).device_state; };
    EXPECT_TRUE(wait([&](const Snapshot& s) { return s.step > 100 && state(s) == "ready"; }));
    session.request({LiveRequest::Kind::kPause, ""});
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.paused; }));
    seen = false;
    EXPECT_TRUE(wait([&](const Snapshot& s) { return state(s) == "retracting"; }));
    EXPECT_TRUE(session.latest().paused);
    seen = true;
    EXPECT_TRUE(wait([&](const Snapshot& s) { return s.paused && state(s) == "ready"; }));
    stop = true;
  });
  session.run(stop);
  viewer.join();
}

TEST(LiveRun, APauseTellsWhatTheDeviceDoesAndOutlastsRestartAndScene) {
  const ScenesWithoutForceLimit scenes;
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.twin = false;
  LiveSession session(options, true);
  std::atomic<bool> stop{false};
  std::thread viewer([&] {
    bool loaded = false, ended = false;
    const auto wait = [&](const auto& condition) {
      for (int i = 0; i < 60000; ++i) {
        session.refresh();
        loaded = loaded || session.loading() == "edge";
        ended = ended || session.latest().finished;
        if (condition(session.latest())) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      return false;
    };
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.step > 300; }));
    session.request({LiveRequest::Kind::kPause, ""});
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.paused; }));
    session.request({LiveRequest::Kind::kStop, ""});
    EXPECT_TRUE(wait(
        [](const Snapshot& s) { return s.paused && s.fingers[0].device_state == "retracting"; }));
    for (const bool restart : {true, false}) {
      const std::uint64_t generation = session.latest().generation;
      session.request({restart ? LiveRequest::Kind::kRestart : LiveRequest::Kind::kScene, "edge"});
      EXPECT_TRUE(wait([&](const Snapshot& s) { return s.generation > generation && s.paused; }));
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      session.refresh();
      EXPECT_TRUE(session.latest().paused);
      EXPECT_TRUE(session.latest().stopped.asked);
      EXPECT_EQ(session.latest().step, 0U);
    }
    // Nor is a release that names another stop than the newest, or is of a run before.
    const auto release = [&](std::uint64_t generation, std::uint32_t stops) {
      LiveRequest request;
      request.kind = LiveRequest::Kind::kRelease;
      request.generation = generation;
      request.stops = stops;
      session.request(request);
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      session.refresh();
      return !session.latest().stopped.asked;
    };
    EXPECT_FALSE(release(session.latest().generation - 1, session.latest().stops));
    EXPECT_FALSE(release(session.latest().generation, session.latest().stops - 1));
    EXPECT_TRUE(loaded);
    EXPECT_FALSE(ended) << "the script was cut short";
    EXPECT_EQ(session.loading(), "");
    session.request({LiveRequest::Kind::kResume, ""});
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.step > 0; }));
    EXPECT_TRUE(session.latest().stopped.asked);
    EXPECT_TRUE(wait([](const Snapshot& s) { return s.stopped.confirmed; }));
    bool released = false;
    for (int i = 0; i < 50 && !released; ++i) {
      released = release(session.latest().generation, session.latest().stops);
    }
    EXPECT_TRUE(released);
    stop = true;
  });
  session.run(stop);
  viewer.join();
}

TEST(LiveRun, ASceneThatCannotBeLoadedIsToldAndTheRunGoesOn) {
  const ScenesWithoutForceLimit scenes;
  std::ofstream(scenes.scene("broken")) << "title = 3\n";
  RunOptions options;
  options.scene = scenes.scene("sphere");
  options.twin = false;
  LiveSession session(options, true);
  std::atomic<bool> stop{false};
  std::vector<std::string> told;
  std::thread viewer([&] {
    session.request({LiveRequest::Kind::kScene, "broken"});
    // A processor that is late has the device's own lines told before it.
    std::string lines;
    for (int i = 0; i < 6000 && lines.find("broken.toml") == std::string::npos; ++i) {
      if (const auto line = session.take_message()) {
        lines += *line + '\n';
      } else {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
    }
    EXPECT_THAT(lines, testing::HasSubstr("broken.toml"));
    session.refresh();
    const std::uint64_t step = session.latest().step;
    for (int i = 0; i < 6000 && session.latest().step <= step; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      session.refresh();
    }
    EXPECT_GT(session.latest().step, step);
    EXPECT_EQ(session.description()->generation, 1u);
    stop = true;
  });
  session.run(stop, {.message = [&](const std::string& line) { told.push_back(line); }});
  viewer.join();
  EXPECT_THAT(told, testing::Contains(testing::HasSubstr("broken.toml")));
}

}  // namespace
}  // namespace softfinger
