// Fingers of one scene share nothing: alone or together, on one thread or three, each has the same
// bits.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <fstream>
#include <map>

#include "../support/folders.hpp"
#include "../support/temporary_directory.hpp"
#include "draw.hpp"
#include "softfinger/recording/recording_reader.hpp"
#include "softfinger/session/live_session.hpp"

namespace softfinger::relations {
namespace {

namespace fs = std::filesystem;

/// One finger's table of a scene: a press with a little slide.
std::string finger_table(Draw& draw, const std::string& name) {
  std::string text =
      fmt::format("[[finger]]\nname = \"{}\"\nmodel = \"{}\"\n", name,
                  (fs::path(source_folder()) / "fingers" / (name + ".toml")).string());
  const double x = draw.between(-8.0, 8.0);
  const double y = draw.between(-8.0, 8.0);
  const double pitch = draw.between(0.0, 20.0);
  for (const auto& [time, height, shift] :
       {std::tuple{0.0, 8.0, 0.0}, std::tuple{0.1, 5.0, 0.0}, std::tuple{0.2, 5.0, 2.0}}) {
    text += fmt::format(
        "[[finger.waypoint]]\ntime_s = {}\nposition_mm = [{}, {}, {}]\nrotation_vector_deg = [0.0, "
        "{}, 0.0]\n",
        time, x + shift, y, height, pitch);
  }
  return text;
}

std::map<std::int64_t, std::vector<StepRecord>> steps_of(const fs::path& scene, int threads) {
  RunOptions options;
  options.scene = scene;
  options.as_fast_as_possible = true;
  options.threads = threads;
  options.recording = scene.parent_path() / "run.db";
  const std::atomic<bool> stop{false};
  (void)run_headless(options, stop);
  std::map<std::int64_t, std::vector<StepRecord>> steps;
  {
    RecordingReader reader(*options.recording);
    StepRecord step;
    while (reader.next(step)) steps[step.finger].push_back(step);
  }
  fs::remove(*options.recording);
  return steps;
}

TEST(SideBySide, EachFingerIsAsItIsAlone) {
  constexpr std::array kFingers{"index", "thumb", "pinky"};
  for (int number = 0; number < cases(1); ++number) {
    const TemporaryDirectory directory;
    Draw draw("side by side", number);
    const std::string object =
        "[[object]]\nname = \"plane\"\nshape = \"plane\"\n[[object]]\nname = \"ball\"\nshape = "
        "\"sphere\"\nradius_mm = 5.0\nposition_mm = [0.0, 0.0, -3.0]\n";
    std::vector<std::string> tables;
    for (const char* name : kFingers) tables.push_back(finger_table(draw, name));
    const auto write = [&](const std::string& text) {
      std::ofstream(directory / "scene.toml") << text << object;
      return directory / "scene.toml";
    };
    const fs::path together = write(tables[0] + tables[1] + tables[2]);
    const auto one_thread = steps_of(together, 1);
    const auto three_threads = steps_of(together, 3);
    for (std::size_t i = 0; i < kFingers.size(); ++i) {
      const auto alone = steps_of(write(tables[i]), 1).at(0);
      double most = 0.0;
      ASSERT_EQ(alone.size(), 201u);
      for (std::size_t k = 0; k < alone.size(); ++k) {
        most = std::max(most, alone[k].normal_force);
        for (const auto* other : {&one_thread, &three_threads}) {
          const StepRecord& step = other->at(static_cast<std::int64_t>(i)).at(k);
          ASSERT_EQ(step.normal_force, alone[k].normal_force) << kFingers[i] << " step " << k;
          ASSERT_EQ(step.tangential_force, alone[k].tangential_force);
          ASSERT_EQ(step.contact_area, alone[k].contact_area);
          ASSERT_EQ(step.X_WF.translation, alone[k].X_WF.translation);
          ASSERT_EQ(step.X_WF.rotation.coeffs(), alone[k].X_WF.rotation.coeffs());
        }
      }
      EXPECT_GT(most, 0.05) << kFingers[i];
    }
  }
}

}  // namespace
}  // namespace softfinger::relations
