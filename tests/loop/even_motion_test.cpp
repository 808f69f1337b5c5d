// A finger that moves evenly, tracked 60 or 120 times a second, feels an even force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/loop/finger_loop.hpp"
#include "softfinger/tracking/conditioning/conditioned_tracker.hpp"
#include "softfinger/tracking/conditioning/degraded_tracker.hpp"

namespace softfinger {
namespace {

constexpr double kSpeed = 0.1;  // m/s, of a stroke

Pose stroke(double time) {
  const double depth = std::min(time / 0.3, 1.0) * 1.2 * mm;
  return {exp_rotation({0.0, 6.0 * deg, 0.0}),
          {kSpeed * std::max(0.0, time - 0.3), 0.0, 6.6 * mm - depth}};
}

/// Greatest departure of the normal force from its mean over the even part of the stroke, as a part
/// of it; of a tracker that sees it `rate` times a second.
double ripple(double rate, bool sent) {
  static const auto model =
      FingerModel::load(std::filesystem::path(SOFTFINGER_SOURCE_DIR) / "fingers/index.toml");
  std::vector<VirtualObject> objects(1);
  objects[0].shape = HalfSpace{};
  const auto tracker = conditioned(
      std::make_unique<DegradedTracker>(
          stroke, TrackingQuality{.rate = rate, .age = 5 * ms, .noise = 0.0, .turn_noise = 0.0}),
      {}, sent);
  FingerLoop loop(0, model, objects, 1000.0, false);
  loop.start(TrackedInput(tracker->sample(0.0)));
  double sum = 0.0, least = 1e9, most = 0.0;
  int count = 0;
  for (int step = 1; step <= 900; ++step) {
    loop.step(step, TrackedInput(tracker->sample(step * 1e-3)));
    if (step <= 500) continue;
    const double force = loop.record().normal_force;
    sum += force;
    ++count;
    least = std::min(least, force);
    most = std::max(most, force);
  }
  const double mean = sum / count;
  EXPECT_GT(mean, 0.2) << "N";
  return std::max(most - mean, mean - least) / mean;
}

TEST(EvenMotion, HasAnEvenForce) {
  for (const double rate : {60.0, 120.0}) {
    const double interpolated = ripple(rate, true);
    const double held = ripple(rate, false);
    std::printf("%3.0f Hz: %.1f %% interpolated, %.1f %% held\n", rate, 100 * interpolated,
                100 * held);
    EXPECT_LT(interpolated, 0.05) << rate;
    EXPECT_GT(held, 0.03) << rate << ": or this test shows nothing";
  }
}

}  // namespace
}  // namespace softfinger
