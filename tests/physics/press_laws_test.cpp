#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "project.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/identification/indentation.hpp"

namespace softfinger {
namespace {

FingerModel index_model() { return *FingerModel::load(kProject / "fingers/index.toml"); }

struct Row {
  double depth, force, touch, least_gap;
};

std::vector<Row> press(const FingerModel& model, const Indenter& indenter,
                       const IndentationOptions& options) {
  std::vector<Row> rows;
  indent(model, indenter, options, [&](const IndentationState& state) {
    double least = 1.0;
    for (const ContactSample& sample : state.contact.samples) least = std::min(least, sample.gap);
    rows.push_back({state.row.indentation, state.row.normal_force,
                    state.X_WF.translation.z() + state.row.indentation, least});
    EXPECT_TRUE(state.row.converged);
  });
  return rows;
}

/// Least gap of the skin's triangles at rest, F at this height.
double gap_of_triangles(const FingerModel& model, const Indenter& indenter, double z) {
  double least = 1.0;
  constexpr int kParts = 24;
  for (const auto& triangle : model.skin_triangles) {
    std::array<Vector3, 3> c;
    for (std::size_t k = 0; k < 3; ++k) {
      const int node = model.sample_nodes[static_cast<std::size_t>(triangle[k])];
      c[k] = model.mesh.nodes[static_cast<std::size_t>(node)] + Vector3(0, 0, z) - indenter.p_FO_W;
    }
    for (int i = 0; i <= kParts; ++i) {
      for (int j = 0; i + j <= kParts; ++j) {
        const double u = static_cast<double>(i) / kParts;
        const double v = static_cast<double>(j) / kParts;
        const Vector3 p = (1.0 - u - v) * c[0] + u * c[1] + v * c[2];
        least = std::min(least, signed_distance(indenter.shape, p).distance);
      }
    }
  }
  return least;
}

TEST(Press, CountsFromWhereTheSkinTouches) {
  const FingerModel model = index_model();
  IndentationOptions options{.depth = 1.0 * mm, .rows = 5};
  for (const double radius : {0.5, 1.0, 3.0, 6.0, 9.0, 9.5, 20.0}) {
    for (const double x : {0.0, 0.7}) {
      const Indenter ball = Indenter::ball(radius * mm, x * mm, x * mm);
      const std::vector<Row> rows = press(model, ball, options);
      const std::string what = std::to_string(radius) + " mm at " + std::to_string(x);
      EXPECT_GT(rows.back().force, 0.02) << what;
      for (std::size_t k = 1; k < rows.size(); ++k) {
        EXPECT_GT(rows[k].force, rows[k - 1].force) << what;
      }
      EXPECT_NEAR(gap_of_triangles(model, ball, rows[0].touch), 0.0, 4e-6) << what;
    }
  }
  for (const double radius : {0.2, 1.0}) {
    const Indenter edge = Indenter::edge(radius * mm);
    const std::vector<Row> rows = press(model, edge, options);
    EXPECT_GT(rows.back().force, 0.02) << radius;
    EXPECT_NEAR(gap_of_triangles(model, edge, rows[0].touch), 0.0, 4e-6) << radius;
  }
}

TEST(Press, BesideTheFingerIsRefused) {
  EXPECT_THROW(press(index_model(), Indenter::ball(1.0 * mm, 60.0 * mm, 0.0), {}), InputError);
}

// Nothing in a frictionless press but its moduli has the unit of a stress.
TEST(Press, ForcesScaleWithAllModuli) {
  const FingerModel soft = index_model();
  for (const Indenter& indenter : {Indenter::plane(), Indenter::ball(6.0 * mm, 0.0, 0.0)}) {
    const IndentationOptions options{.depth = 2.0 * mm, .rows = 4, .friction = false};
    const std::vector<Row> reference = press(soft, indenter, options);
    for (const double factor : {3.0, 100.0}) {
      FingerModel stiff = soft;
      for (auto& material : stiff.materials) material.youngs_modulus *= factor;
      stiff.strain_limits.stiffness *= factor;
      const std::vector<Row> rows = press(stiff, indenter, options);
      for (std::size_t k = 0; k < rows.size(); ++k) {
        EXPECT_GT(reference[k].force, 0.01);
        EXPECT_NEAR(rows[k].force, factor * reference[k].force, 1e-3 * rows[k].force) << factor;
      }
    }
    EXPECT_GT(reference.back().least_gap, -0.04 * mm);
  }
}

// Tissue in motion with its bone has to be stopped: force at speed is more than at rest, and the
// more the faster.
TEST(Press, InertiaAddsForce) {
  const FingerModel model = index_model();
  IndentationOptions options{.depth = 0.1 * mm, .rows = 1, .friction = false};
  double before = press(model, Indenter::plane(), options).back().force;
  EXPECT_GT(before, 0.005);
  for (const double speed : {0.1, 0.5, 1.0}) {
    options.speed = speed;
    const double force = press(model, Indenter::plane(), options).back().force;
    EXPECT_GT(force, 1.05 * before) << speed;
    before = force;
  }
}

}  // namespace
}  // namespace softfinger
