#include "softfinger/rendering.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/session/replay.hpp"

namespace softfinger {
namespace {

const std::filesystem::path kScene =
    std::filesystem::path(source_folder()) / "scenes" / "sphere.toml";

Pose at_height(double z) {
  Pose pose;
  pose.translation = {-3e-3, 0.0, z};
  return pose;
}

/// Down to 2.5 mm into the ball's contact and up again, 1 s.
RenderingSnapshot press(Rendering& rendering, double call_period) {
  RenderingSnapshot deepest;
  const int calls = static_cast<int>(1.0 / call_period + 0.5);
  for (int i = 0; i <= calls; ++i) {
    const double time = i * call_period;
    rendering.step(at_height(29e-3 - 4e-3 * std::min(time, 1.0 - time) * 2.0), 5.0 + time);
    const RenderingSnapshot now = rendering.snapshot();
    if (now.normal_force >= deepest.normal_force) deepest = now;
  }
  return deepest;
}

TEST(Rendering, FingerTouchesAndDeviceAnswers) {
  Rendering rendering(kScene);
  EXPECT_EQ(rendering.simulation_rate(), 1000.0);
  EXPECT_EQ(rendering.device_rate(), 30.0);
  EXPECT_THAT(rendering.configuration_names(),
              testing::ElementsAre("pitch_deg", "roll_deg", "travel_mm"));
  const RenderingSnapshot deepest = press(rendering, 1e-3);
  EXPECT_GT(deepest.normal_force, 0.05);
  EXPECT_GT(deepest.contact_area, 1e-6);
  EXPECT_GT(deepest.mean_normal_F.z(), 0.9);
  EXPECT_EQ(deepest.in_contact.size(), deepest.sample_positions_F.size());
  EXPECT_GT(deepest.X_WF.translation.z(), deepest.X_WFt.translation.z()) << "it stays behind";

  const RenderingCommand& command = rendering.step(at_height(40e-3), 6.001);
  EXPECT_EQ(command.tick, 30);
  EXPECT_EQ(command.configuration.size(), 3);
  EXPECT_EQ(command.joints.size(), 3);
  ASSERT_EQ(command.set_points.size(), 3);
  EXPECT_EQ(command.pulse_widths, command.set_points);
  EXPECT_THAT(command.set_points,
              testing::Each(testing::AllOf(testing::Gt(0.5e-3), testing::Lt(2.5e-3))));
}

TEST(Rendering, SameCallsGiveTheSameBits) {
  Rendering a(kScene), b(kScene);
  const RenderingSnapshot in_a = press(a, 1e-3);
  const RenderingSnapshot in_b = press(b, 1e-3);
  EXPECT_EQ(in_a.X_WF.translation, in_b.X_WF.translation);
  EXPECT_EQ(in_a.normal_force, in_b.normal_force);
  EXPECT_EQ(in_a.sample_positions_F, in_b.sample_positions_F);
}

TEST(Rendering, SlowCallersGetEveryStep) {
  Rendering every_step(kScene), every_frame(kScene);
  const double fine = press(every_step, 1e-3).normal_force;
  const double coarse = press(every_frame, 1.0 / 50.0).normal_force;
  EXPECT_NEAR(coarse, fine, 0.02 * fine);
}

TEST(Rendering, LostTrackingHoldsThenRetracts) {
  Rendering rendering(kScene);
  double time = 0.0;
  for (; time < 1.0; time += 1e-3) rendering.step(at_height(40e-3), time);
  EXPECT_EQ(rendering.step(at_height(40e-3), time).state, "ready");
  Pose nowhere = at_height(40e-3);
  nowhere.translation.x() = std::numeric_limits<double>::quiet_NaN();
  for (const double end = time + 0.15; time < end; time += 1e-3) rendering.step(nowhere, time);
  EXPECT_EQ(rendering.lost(time).state, "holding");
  for (const double end = time + 0.2; time < end; time += 1e-3) rendering.lost(time);
  EXPECT_EQ(rendering.lost(time).state, "retracting");
  EXPECT_TRUE(rendering.snapshot().X_WF.translation.allFinite());
}

TEST(Rendering, OddTimesDoNoHarm) {
  Rendering rendering(kScene);
  rendering.step(at_height(40e-3), 1.7e9);  // a clock of the day
  rendering.step(at_height(40e-3), 1.7e9 + 0.01);
  EXPECT_NEAR(rendering.snapshot().time, 1.7e9 + 0.01, 1e-3);
  rendering.step(at_height(40e-3), 1.0);  // backwards
  rendering.step(at_height(40e-3), std::numeric_limits<double>::quiet_NaN());
  rendering.step(at_height(40e-3), 1.8e9);  // a gap of years is skipped
  EXPECT_NEAR(rendering.snapshot().time, 1.8e9, 1e-3);
}

TEST(Rendering, SaysWhatIsWrong) {
  EXPECT_THROW(Rendering("/no/such/scene.toml"), std::runtime_error);
  RenderingOptions options;
  options.finger = "thumb";
  try {
    Rendering rendering(kScene, options);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("thumb"));
    EXPECT_THAT(error.what(), testing::HasSubstr("index"));
  }
}

// Nothing is known of where it is: not at the origin, inside the ball, nor on the way from there.
TEST(Rendering, AFingerThatWasNeverTrackedTouchesNothing) {
  Rendering rendering(kScene);
  double time = 0.0;
  for (; time < 0.1; time += 1e-3) {
    rendering.lost(time);
    EXPECT_EQ(rendering.snapshot().normal_force, 0.0);
    EXPECT_EQ(rendering.snapshot().contact_area, 0.0);
  }
  double force = 0.0;
  // The first pose comes after 20 ms without a call.
  for (time += 0.02; time < 0.2; time += 1e-3) {
    rendering.step(at_height(25.5e-3), time);
    force = std::max(force, rendering.snapshot().normal_force);
    EXPECT_LT((rendering.snapshot().X_WF.translation - at_height(25.5e-3).translation).norm(),
              2e-3);
  }
  EXPECT_GT(force, 0.05);
  EXPECT_LT(force, 30.0);
}

TEST(Rendering, WhatAProgramDraws) {
  Rendering rendering(kScene);
  rendering.step(at_height(40e-3), 0.0);
  const RenderingSnapshot snapshot = rendering.snapshot();
  ASSERT_FALSE(rendering.skin_triangles().empty());
  std::vector<int> used(snapshot.sample_positions_F.size(), 0);
  const Vector3 inside = Vector3::Zero();  // F's origin is in the bone
  int outward = 0;
  for (const auto& triangle : rendering.skin_triangles()) {
    std::array<Vector3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_GE(triangle[k], 0);
      ASSERT_LT(static_cast<std::size_t>(triangle[k]), used.size());
      used[static_cast<std::size_t>(triangle[k])] = 1;
      corners[k] = snapshot.sample_positions_F[static_cast<std::size_t>(triangle[k])];
    }
    const Vector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    EXPECT_GT(normal.norm(), 0.0);
    outward += normal.dot(corners[0] - inside) > 0.0 ? 1 : 0;
  }
  EXPECT_THAT(used, testing::Each(1));
  EXPECT_EQ(static_cast<std::size_t>(outward), rendering.skin_triangles().size());
  ASSERT_EQ(snapshot.X_WO.size(), 1u);
  EXPECT_EQ(snapshot.X_WO[0].translation, Vector3::Zero());
  EXPECT_THAT(rendering.object_names(), testing::ElementsAre("ball"));
}

TEST(Rendering, RecordsWhatAReplayRepeats) {
  const TemporaryDirectory directory;
  const std::filesystem::path hand = kScene.parent_path() / "hand.toml";
  for (const bool state : {false, true}) {
    RenderingOptions options;
    options.finger = state ? "" : "ring";
    options.recording = directory / "run.sqlite";
    options.record_state = state;
    options.device = kScene.parent_path().parent_path() / "devices/plate-2dof.toml";
    {
      Rendering rendering(state ? kScene : hand, options);
      EXPECT_GT(press(rendering, 2e-3).normal_force, 0.05);
      rendering.close_recording();
      rendering.step(at_height(40e-3), 7.0);
    }
    const ReplayResult replayed = replay({.recording = options.recording, .scene = {}});
    EXPECT_TRUE(replayed.agree) << replayed.difference;
    EXPECT_EQ(replayed.steps, 1000);
    RecordingReader reader(options.recording);
    TickRecord tick;
    EXPECT_TRUE(reader.next(tick));
    EXPECT_THROW(Rendering(kScene, options), std::runtime_error) << "it exists";
    std::filesystem::remove(options.recording);
  }
}

TEST(Rendering, ARecordingIsWholeWithoutBeingClosed) {
  const TemporaryDirectory directory;
  RenderingOptions options;
  options.recording = directory / "run.sqlite";
  {
    Rendering rendering(kScene, options);
    EXPECT_GT(press(rendering, 2e-3).normal_force, 0.05);
  }
  RecordingReader reader(options.recording);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.last_step(), 1000);
}

TEST(Rendering, APersonFileSaysSizesAndRegistration) {
  const TemporaryDirectory directory;
  RenderingOptions options;
  options.person = directory / "anna.toml";
  std::ofstream(options.person) << "[index.size]\nbreadth_mm = 18.0\n"
                                   "[index.registration]\ntranslation_mm = [1.0, 2.0, 3.0]\n"
                                   "rotation_vector_deg = [0.0, 0.0, 90.0]\n";
  const auto breadth = [](const Rendering& rendering) {
    double least = 0.0, most = 0.0;
    for (const Vector3& sample : rendering.snapshot().sample_positions_F) {
      least = std::min(least, sample.y());
      most = std::max(most, sample.y());
    }
    return most - least;
  };
  Rendering anna(kScene, options);
  EXPECT_NEAR(breadth(anna), 18e-3, 1e-9);
  ASSERT_TRUE(anna.registration().has_value());
  EXPECT_NEAR((anna.registration()->translation - Vector3(1e-3, 2e-3, 3e-3)).norm(), 0.0, 1e-12);
  Rendering model(kScene);
  EXPECT_GT(std::abs(breadth(model) - 18e-3), 1e-3);
  EXPECT_FALSE(model.registration().has_value());
}

TEST(Rendering, FilterAndPredictionAreThoseOfARun) {
  const auto tremble = [](const RenderingOptions& options) {
    Rendering rendering(kScene, options);
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0.0, 0.1e-3);
    double square = 0.0;
    for (int frame = 0; frame < 240; ++frame) {
      rendering.step(at_height(40e-3 + noise(random)), frame / 120.0);
      const double off = rendering.snapshot().X_WFt.translation.z() - 40e-3;
      if (frame > 60) square += off * off;
    }
    return std::sqrt(square);
  };
  RenderingOptions options;
  const double plain = tremble(options);
  options.filter = true;
  EXPECT_LT(tremble(options), 0.7 * plain);
  options.filter = false;
  options.predict = 0.02;
  Rendering rendering(kScene, options);
  for (int frame = 0; frame <= 120; ++frame) {
    rendering.step(at_height(60e-3 - 0.02 * frame / 120.0), frame / 120.0);
  }
  EXPECT_NEAR(rendering.snapshot().X_WFt.translation.z(), 40e-3 - 0.02 * 0.02, 1e-5);
  options.predict = 0.2;
  EXPECT_THROW(Rendering(kScene, options), std::runtime_error);
}

TEST(Rendering, ADeviceThatCannotBeOpenedIsAnError) {
  const TemporaryDirectory directory;
  const auto message = [](const RenderingOptions& options, const std::filesystem::path& scene) {
    try {
      Rendering rendering(scene, options);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  RenderingOptions options;
  options.device = directory / "bare.toml";
  std::ifstream shipped(kScene.parent_path().parent_path() / "devices/plate-2dof.toml");
  std::ofstream bare(options.device);
  for (std::string line; std::getline(shipped, line) && line.find("[transport]") != 0;) {
    bare << line << '\n';
  }
  bare.close();
  EXPECT_EQ(message(options, kScene), "");
  options.open_device = true;
  EXPECT_THAT(message(options, kScene),
              testing::AllOf(testing::HasSubstr("bare.toml"), testing::HasSubstr("[transport]"),
                             testing::Not(testing::HasSubstr("\n"))));
  const std::filesystem::path scene = directory / "deviceless.toml";
  std::ofstream(scene) << "[[finger]]\nname = \"index\"\nmodel = \""
                       << (kScene.parent_path().parent_path() / "fingers/index.toml").string()
                       << "\"\n[[finger.waypoint]]\ntime_s = 0.0\nposition_mm = [0.0, 0.0, 0.0]\n"
                          "rotation_vector_deg = [0.0, 0.0, 0.0]\n";
  options.device.clear();
  EXPECT_THAT(message(options, scene), testing::HasSubstr("no device"));
}

/// Holds the finger in contact from `time` on until `done`; false where it never is.
bool hold(Rendering& rendering, double& time, double most,
          const std::function<bool(const RenderingCommand&)>& done) {
  for (const double end = time + most; time < end; time += 1e-3) {
    if (done(rendering.step(at_height(26.5e-3), time))) return true;
  }
  return false;
}

TEST(Rendering, AStopLastsUntilItIsReleasedAndReplays) {
  const TemporaryDirectory directory;
  RenderingOptions options;
  options.recording = directory / "stopped.db";
  Rendering rendering(kScene, options);
  double time = 0.0;
  EXPECT_FALSE(rendering.release()) << "nothing is stopped";
  ASSERT_TRUE(hold(rendering, time, 2.0, [](const auto& c) { return c.state == "rendering"; }));
  rendering.stop();
  ASSERT_TRUE(hold(rendering, time, 0.05, [](const auto& c) { return c.stop_confirmed; }));
  EXPECT_FALSE(hold(rendering, time, 1.0, [](const auto& c) { return c.state != "retracting"; }));
  rendering.stop();
  EXPECT_FALSE(rendering.release()) << "it was stopped again since the last step";
  EXPECT_FALSE(hold(rendering, time, 0.2, [](const auto& c) { return !c.stopped; }));
  EXPECT_TRUE(rendering.release());
  EXPECT_TRUE(hold(rendering, time, 0.1, [](const auto& c) { return !c.stopped; }));
  EXPECT_TRUE(hold(rendering, time, 2.0, [](const auto& c) { return c.state == "rendering"; }));
  rendering.close_recording();
  EXPECT_TRUE(replay({.recording = directory / "stopped.db", .scene = {}}).agree);
}

// The line leads the device away by itself, in a process of its own.
TEST(Rendering, AStopNeedsNoCallOfStep) {
  RenderingOptions options;
  options.open_device = true;
  options.guard_program = guard_program();
  Rendering rendering(kScene, options);
  const auto began = std::chrono::steady_clock::now();
  const auto now = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  std::string_view state;
  while (now() < 30.0 && state != "rendering") {
    state = rendering.step(at_height(26.5e-3), now()).state;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  ASSERT_EQ(state, "rendering");
  rendering.stop();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_TRUE(rendering.step(at_height(26.5e-3), now()).stop_confirmed);
}

TEST(Rendering, TellsOnceWhatAPersonShouldKnowOfTheDevice) {
  const TemporaryDirectory directory;
  RenderingOptions options;
  EXPECT_FALSE(Rendering(kScene, options).take_message().has_value());
  options.device = directory / "hasty.toml";
  std::ifstream shipped(kScene.parent_path().parent_path() / "devices/thimble-3rrs.toml");
  std::ofstream hasty(options.device);
  for (std::string line; std::getline(shipped, line);) {
    hasty << (line.find("approach_mm") == 0 ? "approach_mm = 12.0" : line) << '\n';
  }
  hasty.close();
  Rendering rendering(kScene, options);
  EXPECT_THAT(rendering.take_message().value_or(""), testing::HasSubstr("matching.approach_mm: "));
  EXPECT_FALSE(rendering.take_message().has_value());
}

TEST(Rendering, ADeviceIsNotOpenedWithoutAGuardUnlessAskedTo) {
  RenderingOptions options;
  options.open_device = true;  // nor is there one beside this test
  EXPECT_THROW((void)Rendering(kScene, options), std::runtime_error);
  options.without_guard_process = true;
  EXPECT_NO_THROW((void)Rendering(kScene, options));
}

}  // namespace
}  // namespace softfinger
