// Time in the skin: a finger that relaxes, pressed fast, slowly and held.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "../support/box_finger.hpp"
#include "softfinger/identification/indentation.hpp"

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

TEST(SkinRelaxation, HeldSkinRelaxesAsItsTermsSay) {
  const auto model = relaxing_finger();
  IndentationOptions options;
  options.depth = 1e-3;
  options.rows = 4;
  options.friction = false;
  double instantaneous = 0.0;
  indent(*model, Indenter::plane(), options,
         [&](const IndentationState& state) { instantaneous = state.row.normal_force; });
  options.speed = 0.5;  // 2 ms to the depth
  options.hold = 200e-3;
  std::vector<IndentationRow> rows;
  indent(*model, Indenter::plane(), options,
         [&](const IndentationState& state) { rows.push_back(state.row); });
  ASSERT_EQ(rows.size(), 8u);
  EXPECT_DOUBLE_EQ(rows[3].time, 2e-3);
  EXPECT_DOUBLE_EQ(rows[7].time, 202e-3);
  for (std::size_t k = 4; k < rows.size(); ++k) {
    EXPECT_EQ(rows[k].indentation, options.depth);
    // The first term is long gone; of the second, what has relaxed since the middle of the way.
    const double left = 0.3 + 0.3 * std::exp(-(rows[k].time - 1e-3) / 70e-3);
    EXPECT_NEAR(rows[k].normal_force / instantaneous, left, 0.01) << rows[k].time;
  }
}

TEST(SkinRelaxation, ElasticSkinUnloadsAsItWasLoaded) {
  const auto model = testing_support::box_finger();
  IndentationOptions options;
  options.depth = 1e-3;
  options.rows = 4;
  options.unload = true;
  options.friction = false;
  std::vector<IndentationRow> rows;
  indent(*model, Indenter::plane(), options,
         [&](const IndentationState& state) { rows.push_back(state.row); });
  ASSERT_EQ(rows.size(), 8u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_DOUBLE_EQ(rows[6 - k].indentation, rows[k].indentation);
    EXPECT_NEAR(rows[6 - k].normal_force, rows[k].normal_force, 1e-7);
  }
  EXPECT_EQ(rows[7].indentation, 0.0);
  EXPECT_NEAR(rows[7].normal_force, 0.0, 1e-9);
}

}  // namespace
}  // namespace softfinger
