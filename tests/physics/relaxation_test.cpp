// Time in the skin: a finger that relaxes, pressed fast, slowly and held.

#include <gtest/gtest.h>

#include "../support/box_finger.hpp"
#include "softfinger/finger/indentation.hpp"

namespace softfinger {
namespace {

std::shared_ptr<FingerModel> relaxing_finger() {
  auto model = testing_support::box_finger();
  model->relaxation = {{{0.4, 4e-3}, {0.3, 70e-3}}};
  return model;
}

double force_at(const FingerModel& model, double speed, bool relaxed) {
  IndentationOptions options;
  options.depth = 1e-3;
  options.rows = 4;
  options.speed = speed;
  options.relaxed = relaxed;
  options.friction = false;
  double force = 0.0;
  indent(model, Indenter::plane(), options, [&](const IndentationState& state) {
    EXPECT_TRUE(state.row.converged);
    force = state.row.normal_force;
  });
  return force;
}

TEST(SkinRelaxation, AFastPressMeetsTheInstantaneousSkinASlowOneTheRelaxed) {
  const auto model = relaxing_finger();
  const double instantaneous = force_at(*model, 0.0, false);
  const double relaxed = force_at(*model, 0.0, true);
  // All stress relaxes alike, and nothing but stress resists.
  EXPECT_NEAR(relaxed, 0.3 * instantaneous, 1e-3 * instantaneous);
  // 2 s for 1 mm: long against both times.
  const double slow = force_at(*model, 0.5e-3, false);
  EXPECT_GT(slow, relaxed);
  EXPECT_LT(slow, 1.1 * relaxed);
  double last = slow;
  for (const double speed : {5e-3, 50e-3, 200e-3}) {
    const double force = force_at(*model, speed, false);
    EXPECT_GT(force, last) << speed;
    last = force;
  }
}

}  // namespace
}  // namespace softfinger
