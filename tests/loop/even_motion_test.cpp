// A finger that moves evenly, tracked 60 or 120 times a second, feels an even force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "../support/folders.hpp"
#include "../support/sent_motion.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/loop/finger_loop.hpp"
#include "softfinger/tracking/conditioning/conditioned_tracker.hpp"

namespace softfinger {
namespace {

constexpr double kStrokeSpeed = 0.1;  // m/s
constexpr int kEvenFrom = 1000;       // steps: pressed, on its way and used to its sender
constexpr int kEvenUntil = 3000;

/// Down on a plane, then along it.
Pose stroke(double time) {
  const double depth = std::min(time / 0.3, 1.0) * 1.2 * mm;
  return {exp_rotation({0.0, 6.0 * deg, 0.0}),
          {kStrokeSpeed * std::max(0.0, time - 0.3), 0.0, 6.6 * mm - depth}};
}

/// Greatest less least, as a part of the mean.
class Ripple {
 public:
  void add(double value) {
    least_ = std::min(least_, value);
    most_ = std::max(most_, value);
    sum_ += value;
    ++count_;
  }
  [[nodiscard]] double mean() const { return sum_ / count_; }
  [[nodiscard]] double value() const { return (most_ - least_) / mean(); }

 private:
  double least_ = 1e9, most_ = 0.0, sum_ = 0.0;
  int count_ = 0;
};

struct StrokeForces {
  Ripple normal, tangential;
  double delay = 0.0;  ///< s, greatest, beside the shortest way of a pose
};

/// Of the even part of the stroke; held: as before poses were interpolated.
StrokeForces stroke_forces(const Sending& sending, bool held) {
  static const auto model =
      FingerModel::load(std::filesystem::path(source_folder()) / "fingers/index.toml");
  std::vector<VirtualObject> objects(1);
  objects[0].shape = HalfSpace{};
  const auto tracker = conditioned(std::make_unique<SentMotion>(stroke, sending), {}, !held);
  FingerLoop loop(0, model, objects, 1000.0, false);
  loop.start(TrackedInput(tracker->sample(0.0)));
  StrokeForces forces;
  for (int step = 1; step <= kEvenUntil; ++step) {
    const TrackedPose pose = tracker->sample(step * 1e-3);
    loop.step(step, TrackedInput(pose));
    if (step <= kEvenFrom) continue;
    forces.delay = std::max(forces.delay, step * 1e-3 - pose.time);
    forces.normal.add(loop.record().normal_force);
    forces.tangential.add(loop.record().tangential_force);
  }
  EXPECT_GT(forces.normal.mean(), 0.2) << "N";
  if (!held) {
    EXPECT_NEAR(forces.tangential.mean(), 0.5 * forces.normal.mean(), 0.05) << "N: it slides";
  }
  return forces;
}

struct NamedSending {
  std::string name;
  Sending sending;
};

void print(double rate, const std::string& name, const StrokeForces& forces) {
  std::printf("%3.0f Hz, %s: normal %.1f %%, tangential %.1f %%, %.0f ms behind\n", rate,
              name.c_str(), 100 * forces.normal.value(), 100 * forces.tangential.value(),
              forces.delay / ms);
}

TEST(EvenMotion, HasAnEvenForce) {
  const std::vector<NamedSending> senders{
      {"regular", {}},
      {"5 ms late, stamps off by 1 ms", {.way_jitter = 5 * ms, .stamp_jitter = 1 * ms}},
      {"3 ms late, stamps off by 3 ms", {.way_jitter = 3 * ms, .stamp_jitter = 3 * ms}},
      {"5 ms late, no stamps", {.way_jitter = 5 * ms, .stamped = false}}};
  for (const auto& [name, regular] : senders) {
    for (const double rate : {60.0, 120.0}) {
      Sending sending = regular;
      sending.rate = rate;
      const StrokeForces forces = stroke_forces(sending, false);
      print(rate, name, forces);
      EXPECT_LT(forces.normal.value(), 0.05) << rate << " Hz, " << name;
      EXPECT_LT(forces.tangential.value(), 0.05) << rate << " Hz, " << name;
    }
  }
}

TEST(EvenMotion, HasNoneWherePosesAreHeld) {
  for (const double rate : {60.0, 120.0}) {
    const StrokeForces forces = stroke_forces({.rate = rate}, true);
    print(rate, "held", forces);
    EXPECT_GT(forces.normal.value(), 0.08) << "or the test above shows nothing";
    EXPECT_GT(forces.tangential.value(), 0.12);
  }
}

// Where the next pose is lost the newest is held, which is felt, but less than a jump.
TEST(EvenMotion, LostPosesAreFeltLessThanHeldOnes) {
  for (const double rate : {60.0, 120.0}) {
    const Sending sending{.rate = rate, .way_jitter = 2 * ms, .loss = 0.3};
    const StrokeForces forces = stroke_forces(sending, false);
    const StrokeForces held = stroke_forces(sending, true);
    print(rate, "30 % lost", forces);
    print(rate, "30 % lost, held", held);
    EXPECT_LT(forces.normal.value(), 0.5 * held.normal.value()) << rate << " Hz";
    EXPECT_LT(forces.tangential.value(), 0.5 * held.tangential.value()) << rate << " Hz";
  }
}

}  // namespace
}  // namespace softfinger
