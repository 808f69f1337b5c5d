// How finely time is cut, by how many threads and with which instructions, is not what happens.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "../support/folders.hpp"
#include "drawn_exploration.hpp"
#include "softfinger/base/instruction_set.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger::relations {
namespace {

// An implicit step damps what oscillates, the more the longer it is: on the way the forces
// differ, at rest only by where friction caught the skin. Shipped constants at rest after 0.25 s:
// the bone's own oscillation, 10 g on 1 N/mm, has died away.
TEST(Steps, From100HertzTo20Kilohertz) {
  for (int number = 0; number < cases(4); ++number) {
    Draw draw("steps", number);
    Exploration exploration = draw_exploration(draw, number, kSmoothThings, {Path::kPress});
    double reference = 0.0;
    for (const double rate : {1000.0, 100.0, 300.0, 5000.0, number == 0 ? 20000.0 : 2000.0}) {
      exploration.rate = rate;
      const double force = explore(exploration).last().normal_force;
      if (reference == 0.0) reference = force;
      ASSERT_GT(force, 0.01) << exploration.what;
      EXPECT_NEAR(force, reference, (rate < 200.0 ? 0.06 : 0.03) * reference)
          << exploration.what << " at " << rate;
    }
  }
}

// The same bits.
TEST(Steps, OnAnyNumberOfThreads) {
  const auto medium =
      FingerModel::load(std::filesystem::path(source_folder()) / "fingers/index-medium.toml");
  for (int number = 0; number < cases(2); ++number) {
    Draw draw("threads", number);
    Exploration exploration = draw_exploration(draw, number, kAllThings, {Path::kTap});
    exploration.model = medium;
    const Pose touch = touching(*medium, exploration.objects.front(), Matrix3::Identity());
    Pose pressed = touch;
    pressed.translation.z() -= 1 * mm;
    exploration.motion = Trajectory({{0.0, touch}, {0.03, pressed}, {0.06, touch}});
    const Trace alone = explore(exploration);
    ASSERT_GT(alone.most_force, 0.01) << exploration.what;
    for (const int threads : {2, 3}) {
      ThreadTeam team(threads);
      const Trace shared = explore(exploration, {}, &team);
      EXPECT_EQ(shared.hash, alone.hash) << exploration.what << ", " << threads << " threads";
    }
  }
}

/// Chooses a set for as long as it lives.
class WithInstructions {
 public:
  explicit WithInstructions(InstructionSet set) { choose_instruction_set(name_of(set)); }
  ~WithInstructions() { choose_instruction_set(name_of(best_instruction_set())); }
  WithInstructions(const WithInstructions&) = delete;
  WithInstructions& operator=(const WithInstructions&) = delete;
};

// Rounding, and where the iterations of a step end, 1e-6 of its residual; a grid's distance has
// kinks.
constexpr double kOfSets = 1e-3;

TEST(Steps, WithEveryInstructionSet) {
  for (int number = 0; number < cases(5); ++number) {
    Draw draw("instructions", number);
    const Exploration exploration = draw_exploration(draw, number, kSmoothThings);
    const auto with = [&](InstructionSet set) {
      const WithInstructions chosen(set);
      return explore(exploration);
    };
    const Trace plain = with(InstructionSet::kBaseline);
    ASSERT_GT(plain.most_force, 0.01) << exploration.what;
    for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
      if (set > best_instruction_set()) continue;
      const Trace other = with(set);
      EXPECT_NE(other.hash, plain.hash) << "the same kernels: this shows nothing";
      expect_agreement(departure(plain, other), exploration, kOfSets,
                       fmt::format(", {}", name_of(set)));
    }
  }
}

}  // namespace
}  // namespace softfinger::relations
