#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "project.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/identification/indentation.hpp"

// Points inside triangles as members of the contact set, where edges press between samples.
namespace softfinger {
namespace {

struct Edge {
  double radius, pitch, depth;  // mm, degrees, mm
};

constexpr Edge kEdges[] = {{1.0, 25.0, 0.75}, {1.0, 45.0, 1.5}, {1.5, 45.0, 1.5}, {1.0, 6.0, 1.5}};

template <typename See>
void press_on(const Edge& edge, const See& see) {
  static const auto model = FingerModel::load(kProject / "fingers/index.toml");
  IndentationOptions options;
  options.depth = edge.depth * mm;
  options.rows = 10;
  options.pitch = edge.pitch * deg;
  options.friction = false;
  indent(*model, Indenter::edge(edge.radius * mm), options,
         [&](const IndentationState& state) { see(state); });
}

TEST(FeatureSet, MembersBearAllOfTheForce) {
  double most_by_features = 0.0;
  for (const Edge& edge : kEdges) {
    int rows = 0;
    press_on(edge, [&](const IndentationState& state) {
      const ContactSet& contact = state.contact;
      double by_samples = 0.0;
      double by_features = 0.0;
      for (const ContactSample& sample : contact.samples) {
        if (sample.in_contact) by_samples += sample.own_normal_force;
      }
      for (const ContactFeature& feature : contact.features()) {
        by_features += feature.normal_force_F.norm();
        EXPECT_LT(std::abs(feature.gap), 0.2 * mm);
      }
      ASSERT_GT(contact.normal_force, 1e-3) << edge.radius << ' ' << edge.pitch;
      EXPECT_NEAR(by_samples + by_features, contact.normal_force_sum,
                  1e-3 * contact.normal_force_sum)
          << edge.radius << ' ' << edge.pitch;
      EXPECT_GT(contact.contact_count, 0);
      EXPECT_GT(contact.contact_area, 0.0);
      most_by_features = std::max(most_by_features, by_features / contact.normal_force_sum);
      ++rows;
    });
    EXPECT_EQ(rows, 10);
  }
  EXPECT_GT(most_by_features, 0.3);
}

// What a feature stands for its corners give up: the skin has the area that it has.
TEST(FeatureSet, SharesTheAreaOfTheSkin) {
  int with_features = 0;
  for (const Edge& edge : kEdges) {
    press_on(edge, [&](const IndentationState& state) {
      double shared = 0.0, all = 0.0, forces = 0.0;
      Vector3 of_corners = Vector3::Zero();
      for (const ContactSample& sample : state.contact.samples) {
        shared += sample.weight();
        all += sample.rest_area;
        EXPECT_GE(sample.taken, 0.0);
        EXPECT_LE(sample.taken, 1.0);
        forces += sample.normal_force;
        of_corners += sample.normal_force_F;
      }
      EXPECT_GT(forces, 0.0);
      EXPECT_NEAR(of_corners.norm(), state.contact.normal_force, 1e-9 * forces);
      for (const ContactFeature& feature : state.contact.features()) {
        EXPECT_GT(feature.rest_area, 0.0);
        EXPECT_GT(feature.area, 0.0);
        EXPECT_NEAR(feature.weights[0] + feature.weights[1] + feature.weights[2], 1.0, 1e-12);
        shared += feature.rest_area;
        ++with_features;
      }
      EXPECT_NEAR(shared, all, 1e-9 * all);
      EXPECT_GT(state.contact.contact_area, 0.0);
    });
  }
  EXPECT_GT(with_features, 20);
}

}  // namespace
}  // namespace softfinger
