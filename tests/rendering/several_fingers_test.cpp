// All fingers of a scene in one Rendering: they hold between them what moves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/rendering.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/session/live_session.hpp"
#include "softfinger/session/replay.hpp"

namespace softfinger {
namespace {

const std::filesystem::path kRoot = source_folder();
const std::filesystem::path kCup = kRoot / "scenes/cup.toml";
const std::filesystem::path kSponge = kRoot / "scenes/sponge.toml";
constexpr double kRate = 1000.0;  ///< Hz

using Poses = std::vector<std::optional<Pose>>;

/// The scene's own script, as a program hands it over.
class Script {
 public:
  explicit Script(const std::filesystem::path& scene) {
    for (const SceneFinger& finger : load_scene(scene).fingers)
      ways_.emplace_back(finger.waypoints);
  }
  [[nodiscard]] Poses at(double time) const {
    Poses poses;
    for (const Trajectory& way : ways_) poses.emplace_back(way.sample(time));
    return poses;
  }

 private:
  std::vector<Trajectory> ways_;
};

void follow(Rendering& rendering, const Script& script, double until) {
  const auto steps = static_cast<int>(std::round(until * kRate));
  for (int i = 0; i <= steps; ++i) {
    const double time = i / kRate;
    rendering.step(script.at(time), time);
  }
}

RenderingOptions all_fingers() {
  RenderingOptions options;
  options.all_fingers = true;
  return options;
}

std::size_t place_of(const Rendering& rendering, const std::string& object) {
  const std::vector<std::string> names = rendering.object_names();
  return static_cast<std::size_t>(std::ranges::find(names, object) - names.begin());
}

TEST(SeveralFingers, LiftACupBetweenThem) {
  const TemporaryDirectory directory;
  RenderingOptions options = all_fingers();
  options.recording = directory / "cup.sqlite";
  Rendering rendering(kCup, options);
  EXPECT_EQ(rendering.finger_count(), 2U);
  EXPECT_THAT(rendering.finger_names(), testing::ElementsAre("index", "thumb"));
  follow(rendering, Script(kCup), 2.4);
  RenderingSnapshot index;
  RenderingSnapshot thumb;
  rendering.snapshot(index, 0);
  rendering.snapshot(thumb, 1);
  EXPECT_GT(index.normal_force, 1.0);
  EXPECT_NEAR(index.normal_force, thumb.normal_force, 0.05);
  const RenderingObject& cup = index.objects[place_of(rendering, "cup")];
  EXPECT_TRUE(cup.moves);
  EXPECT_GT(cup.X_WO.translation.z(), 42e-3) << "it stood at 40 mm";
  EXPECT_GT(cup.velocity.z(), 10e-3);
  EXPECT_TRUE(std::isnan(cup.joint));
  EXPECT_FALSE(index.objects[place_of(rendering, "table")].moves);
  for (std::size_t finger : {0U, 1U}) {
    EXPECT_EQ(rendering.command(finger).configuration.size(), 3) << finger;
    EXPECT_EQ(rendering.command(finger).state, "rendering") << finger;
  }

  // Each finger meets it once, and it leaves the table.
  std::map<std::string, int> told;
  while (const auto event = rendering.take_event()) {
    std::string words(event->kind);
    if (event->other_finger) words += " " + rendering.finger_names()[*event->other_finger];
    if (event->other_object) words += " " + rendering.object_names()[*event->other_object];
    ++told[words];
    EXPECT_EQ(event->object, place_of(rendering, "cup"));
    EXPECT_GT(event->time, 0.0);
    EXPECT_LT(event->time, 2.4);
  }
  EXPECT_EQ(told["impact index"], 1);
  EXPECT_EQ(told["impact thumb"], 1);
  EXPECT_EQ(told["release table"], 1);

  rendering.close_recording();
  const ReplayResult replayed = replay({.recording = options.recording, .scene = {}});
  EXPECT_TRUE(replayed.agree) << replayed.difference;
  EXPECT_EQ(replayed.steps, 2400);
}

TEST(SeveralFingers, GiveTheBitsOfARunOnAnyNumberOfThreads) {
  const TemporaryDirectory directory;
  RunOptions run;
  run.scene = kSponge;
  run.as_fast_as_possible = true;
  run.duration = 0.7;
  run.recording = directory / "run.sqlite";
  std::atomic<bool> stop{false};
  run_headless(run, stop);
  std::vector<StepRecord> steps;
  RecordingReader reader(*run.recording);
  for (StepRecord step; reader.next(step);) {
    if (step.step == 700) steps.push_back(step);
  }
  ASSERT_EQ(steps.size(), 2U);
  for (const int threads : {1, 2}) {
    RenderingOptions options = all_fingers();
    options.threads = threads;
    Rendering rendering(kSponge, options);
    follow(rendering, Script(kSponge), 0.7);
    RenderingSnapshot snapshot;
    for (std::size_t finger : {0U, 1U}) {
      rendering.snapshot(snapshot, finger);
      EXPECT_GT(snapshot.normal_force, 0.1);
      EXPECT_EQ(snapshot.normal_force, steps[finger].normal_force) << finger;
      EXPECT_EQ(snapshot.X_WF.translation, steps[finger].X_WF.translation) << finger;
    }
  }
}

TEST(SeveralFingers, SeeHowSomethingSoftGivesWay) {
  Rendering rendering(kSponge, all_fingers());
  const std::size_t sponge = place_of(rendering, "sponge");
  const Script script(kSponge);
  rendering.step(script.at(0.0), 0.0);
  std::vector<Vector3> rest;
  rendering.object_positions(sponge, rest);
  std::vector<int> used(rest.size(), 0);
  for (const auto& triangle : rendering.object_triangles(sponge)) {
    for (const int corner : triangle) used.at(static_cast<std::size_t>(corner)) = 1;
  }
  EXPECT_GT(rest.size(), 100U);
  EXPECT_THAT(used, testing::Each(1));
  follow(rendering, script, 0.9);
  std::vector<Vector3> squeezed;
  rendering.object_positions(sponge, squeezed);
  ASSERT_EQ(squeezed.size(), rest.size());
  double most = 0.0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    most = std::max(most, (squeezed[i] - rest[i]).norm());
  }
  EXPECT_GT(most, 1e-3);
  EXPECT_LT(most, 20e-3);
  const std::size_t table = place_of(rendering, "table");
  EXPECT_TRUE(rendering.object_triangles(table).empty());
  rendering.object_positions(table, squeezed);
  EXPECT_TRUE(squeezed.empty());
}

// One that nobody sees touches nothing, whatever the others do.
TEST(SeveralFingers, OneMayBeLost) {
  Rendering rendering(kCup, all_fingers());
  const Script script(kCup);
  for (int i = 0; i <= 1500; ++i) {
    Poses poses = script.at(i / kRate);
    poses[1].reset();
    rendering.step(poses, i / kRate);
  }
  RenderingSnapshot index;
  RenderingSnapshot thumb;
  rendering.snapshot(index, 0);
  rendering.snapshot(thumb, 1);
  EXPECT_GT(index.normal_force, 0.05) << "it pushes the cup along";
  EXPECT_EQ(thumb.normal_force, 0.0);
  EXPECT_LT(index.objects[place_of(rendering, "cup")].X_WO.translation.x(), -0.5e-3);
  EXPECT_EQ(rendering.command(1).state, "retracting");
}

TEST(SeveralFingers, WhatIsWrongIsSaid) {
  Rendering rendering(kCup, all_fingers());
  EXPECT_THROW(rendering.step(Pose(), 0.0), std::runtime_error) << "a pose for each";
  RenderingOptions options = all_fingers();
  options.device = "thumb=" + (kRoot / "devices/plate-2dof.toml").string();
  EXPECT_EQ(Rendering(kCup, options).configuration_names(1).size(), 2U);
  options.device = kRoot / "devices/plate-2dof.toml";
  EXPECT_THROW(Rendering(kCup, options), std::runtime_error) << "whose?";
  options = all_fingers();
  options.threads = 0;
  EXPECT_THROW(Rendering(kCup, options), std::runtime_error);
}

}  // namespace
}  // namespace softfinger
