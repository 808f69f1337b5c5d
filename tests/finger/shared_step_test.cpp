// Threads change how long a step takes and nothing else.

#include <gtest/gtest.h>

#include <filesystem>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/threads/thread_team.hpp"

namespace softfinger {
namespace {

const std::filesystem::path kRoot = source_folder();

std::vector<std::uint64_t> hashes_of_a_press(const std::string& finger, int threads) {
  VirtualObject plate;
  plate.shape = HalfSpace{};
  plate.motion = Trajectory(std::vector<Waypoint>{{0.0, Pose{}}});
  ThreadTeam team(threads);
  FingerSimulation simulation(FingerModel::load(kRoot / "fingers" / finger), {&plate, 1}, 4e-3,
                              threads > 1 ? &team : nullptr);
  const auto pose = [](int k) {
    return Pose{exp_rotation(Vector3(0.02 * k, 0.0, 0.0)),
                Vector3(0.2 * mm * k, 0.0, (7.6 - 0.15 * k) * mm)};
  };
  simulation.reset(pose(0));
  std::vector<std::uint64_t> hashes;
  for (int k = 1; k <= 20; ++k) {
    EXPECT_TRUE(simulation.step(pose(k), 4e-3 * k).converged);
    hashes.push_back(simulation.state_hash());
  }
  EXPECT_GT(simulation.contact().normal_force, 0.1);
  return hashes;
}

TEST(SharedStep, HasTheSameBitsOnAnyNumberOfThreads) {
  for (const char* finger : {"index-medium.toml", "index-layered.toml"}) {
    const auto alone = hashes_of_a_press(finger, 1);
    for (const int threads : {2, 3}) {
      EXPECT_EQ(hashes_of_a_press(finger, threads), alone) << finger << ", " << threads;
    }
  }
}

}  // namespace
}  // namespace softfinger
