#include "softfinger/contact/contact_report.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <vector>

namespace softfinger {
namespace {

constexpr double kSide = 1e-3;
constexpr double kTolerance = 5e-5;
constexpr double kDepth = 5e-5;

/// Four samples, the corners of a square of two triangles, over a table; after them one feature in
/// the middle of the first triangle. F is W, turned half about x.
class ContactReport : public ::testing::Test {
 protected:
  ContactReport() : potential({kThird * 2, kThird, kThird * 2, kThird, 2e-6}, 4, 1, {}) {
    obstacle.shape = &table;
    obstacle.friction_coefficient = 0.5;
    anchors = potential.no_anchors();
  }
  /// With the samples and the feature's point at these heights over the table, m.
  ContactSet report(const std::array<double, 4>& heights, double feature_height) {
    const Pose X_WF{exp_rotation(Vector3(std::numbers::pi, 0.0, 0.0)), Vector3(0.0, 0.0, 0.01)};
    std::vector<Vector3> positions;
    for (std::size_t i = 0; i < 4; ++i) positions.push_back(rest[i] + Vector3(0, 0, heights[i]));
    positions.push_back((rest[0] + rest[1] + rest[2]) / 3.0 + Vector3(0, 0, feature_height));
    potential.begin({&obstacle, 1}, anchors);
    potential.add_plane({.obstacle = 0, .normal = Vector3::UnitZ(), .offset = 0.0});
    std::vector<Vector3> gradient(positions.size(), Vector3::Zero());
    potential.energy_gradient(positions, gradient);
    for (const Vector3& g : gradient) force -= g;
    ContactSet set = make_contact_set(skin(), 0.3);
    report_contact(skin(),
                   {.potential = potential,
                    .positions = positions,
                    .features = {&feature, 1},
                    .feature_depth = kDepth,
                    .tolerance = kTolerance,
                    .X_WF = X_WF},
                   set);
    return set;
  }
  [[nodiscard]] SkinSurface skin() const { return {rest, sample_nodes, areas, triangles}; }

  static constexpr double kThird = kSide * kSide / 6.0;
  const std::vector<Vector3> rest{{0, 0, 0}, {kSide, 0, 0}, {kSide, kSide, 0}, {0, kSide, 0}};
  const std::vector<int> sample_nodes{0, 1, 2, 3};
  const std::vector<double> areas{2 * kThird, kThird, 2 * kThird, kThird};
  const std::vector<std::array<int, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  const FeaturePlace feature{.obstacle = 0,
                             .samples = {0, 1, 2},
                             .weights = {1.0 / 3, 1.0 / 3, 1.0 / 3},
                             .offset = Vector3(0, 0, kDepth)};
  const Shape table = HalfSpace{};
  Obstacle obstacle;
  std::vector<FrictionAnchor> anchors;
  ContactPotential potential;
  Vector3 force = Vector3::Zero();  ///< on the skin, W, N
};

TEST_F(ContactReport, ASampleIsInContactWhereItIsPressed) {
  const ContactSet set = report({-1e-6, 1e-6, 0.02, -2e-6}, 0.02);
  EXPECT_TRUE(set.samples[0].in_contact);
  EXPECT_FALSE(set.samples[1].in_contact);  // near enough, yet nothing presses
  EXPECT_FALSE(set.samples[2].in_contact);
  EXPECT_TRUE(set.samples[3].in_contact);
  EXPECT_EQ(set.contact_count, 2);
  EXPECT_EQ(set.feature_count, 0U);
  EXPECT_NEAR(set.least_gap, -2e-6, 1e-15);
  EXPECT_GT(set.contact_area, 0.0) << "along the side from the first to the last";
  EXPECT_LT(set.contact_area, 0.2 * kSide * kSide);
  EXPECT_EQ(set.friction_coefficient, 0.5);
}

TEST_F(ContactReport, NothingTouchesWhereNothingIsNear) {
  const ContactSet set = report({0.01, 0.02, 0.02, 0.02}, 0.02);
  EXPECT_EQ(set.contact_count, 0);
  EXPECT_EQ(set.contact_area, 0.0);
  EXPECT_EQ(set.normal_force, 0.0);
  EXPECT_EQ(set.centroid_F, Vector3::Zero());
  EXPECT_EQ(set.mean_normal_F, Vector3::Zero());
  EXPECT_EQ(set.friction_coefficient, 0.3);  // still the finger's
}

TEST_F(ContactReport, MembersBearAllOfTheForce) {
  const ContactSet set = report({-1e-6, 0.01, 0.02, -2e-6}, -1e-6);
  ASSERT_EQ(set.feature_count, 1U);
  EXPECT_EQ(set.contact_count, 3);
  EXPECT_NEAR(set.normal_force, force.z(), 1e-12 * force.z());
  EXPECT_NEAR(set.normal_force_sum, force.z(), 1e-12 * force.z());
  EXPECT_NEAR((set.mean_normal_F + Vector3::UnitZ()).norm(), 0.0, 1e-12);  // F is turned over
  double members = set.features()[0].normal_force_F.norm();
  for (const ContactSample& sample : set.samples) {
    if (sample.in_contact) members += sample.own_normal_force;
  }
  EXPECT_NEAR(members, force.z(), 1e-12 * force.z());
  EXPECT_NEAR(set.features()[0].gap, -1e-6 - kDepth, 1e-15);
}

// What a feature stands for it takes from the corners of its triangle, whether these touch or not.
TEST_F(ContactReport, AFeatureTakesItsAreaFromTheCorners) {
  const ContactSet set = report({0.01, 0.01, 0.01, 0.01}, -1e-6);
  ASSERT_EQ(set.feature_count, 1U);
  const ContactFeature& feature_in_contact = set.features()[0];
  EXPECT_GT(feature_in_contact.rest_area, 0.0);
  double taken = 0.0, weights = 0.0;
  for (const ContactSample& sample : set.samples) {
    taken += sample.taken * sample.rest_area;
    weights += sample.weight();
  }
  EXPECT_NEAR(taken, feature_in_contact.rest_area, 1e-12 * taken);
  EXPECT_NEAR(weights + feature_in_contact.rest_area, kSide * kSide, 1e-12 * kSide * kSide);
  EXPECT_GT(set.contact_area, 0.0);
  EXPECT_LT(set.contact_area, feature_in_contact.area);
  EXPECT_EQ(set.samples[3].taken, 0.0);
}

}  // namespace
}  // namespace softfinger
