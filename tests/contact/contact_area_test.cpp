#include "softfinger/contact/contact_area.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace softfinger {
namespace {

// Johnson, "Contact Mechanics": a round flat punch of radius a goes P (1 - nu^2) / (2 a E) deep.
TEST(PunchDepth, IsThatOfARoundPunch) {
  const double radius = 2e-3, force = 0.7, modulus = 5e4;
  EXPECT_DOUBLE_EQ(punch_depth(force, std::numbers::pi * radius * radius, modulus),
                   force / (2.0 * radius * modulus));
  EXPECT_EQ(punch_depth(0.0, 1e-6, modulus), 0.0);
  EXPECT_EQ(punch_depth(force, 0.0, modulus), 0.0);
  EXPECT_EQ(punch_depth(force, 1e-6, std::numeric_limits<double>::infinity()), 0.0);
}

/// A bowl of skin, a cap of a ball in triangles of a side, over a table.
class Bowl {
 public:
  static constexpr double kRadius = 8e-3;
  explicit Bowl(double side) {
    const int rings = static_cast<int>(std::lround(6e-3 / side));
    add(0.0, 0.0);
    for (int ring = 1; ring <= rings; ++ring) {
      for (int k = 0; k < 6 * ring; ++k) {
        add(ring * 6e-3 / rings, std::numbers::pi * k / (3.0 * ring));
      }
    }
    const auto first = [](int ring) { return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1); };
    for (int ring = 1; ring <= rings; ++ring) {
      for (int sector = 0; sector < 6; ++sector) {
        for (int k = 0; k < ring; ++k) {
          const int out = first(ring) + sector * ring + k;
          const int out_next = first(ring) + (sector * ring + k + 1) % (6 * ring);
          const auto inner = [&](int j) {
            return ring == 1 ? 0 : first(ring - 1) + (sector * (ring - 1) + j) % (6 * (ring - 1));
          };
          triangles_.push_back({inner(k), out_next, out});
          if (k + 1 < ring) triangles_.push_back({inner(k), inner(k + 1), out_next});
        }
      }
    }
    areas_.assign(rest_.size(), 1e-7);
    for (std::size_t i = 0; i < rest_.size(); ++i) nodes_.push_back(static_cast<int>(i));
  }
  /// As it is, its lowest point at this height over the table, m.
  [[nodiscard]] ContactSet at(double height) const {
    ContactPotential potential(areas_, areas_.size(), 1, {});
    const Shape table = HalfSpace{};
    Obstacle obstacle;
    obstacle.shape = &table;
    const std::vector<FrictionAnchor> anchors = potential.no_anchors();
    std::vector<Vector3> positions = rest_;
    for (Vector3& position : positions) position.z() += height;
    potential.begin({&obstacle, 1}, anchors);
    std::vector<Vector3> gradient(positions.size(), Vector3::Zero());
    potential.energy_gradient(positions, gradient);
    const SkinSurface skin{rest_, nodes_, areas_, triangles_};
    ContactSet set = make_contact_set(skin, 0.0);
    report_contact(skin,
                   {.potential = potential,
                    .positions = positions,
                    .features = {},
                    .tolerance = kTolerance,
                    .X_WF = Pose()},
                   set);
    return set;
  }
  static constexpr double kTolerance = 5e-5;

  /// Area of the places, many in each triangle, that `set` has in contact.
  [[nodiscard]] double area_of_places(const ContactSet& set) const {
    constexpr int kParts = 24;
    double sum = 0.0;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const TriangleInContact touched(set, t, triangles_[t]);
      const auto at = [&](std::size_t c) {
        return rest_[static_cast<std::size_t>(triangles_[t][c])];
      };
      const double area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
      int within = 0;
      for (int i = 0; i < kParts; ++i) {
        for (int j = 0; i + j < kParts; ++j) {
          const double a = (i + 1.0 / 3.0) / kParts, b = (j + 1.0 / 3.0) / kParts;
          within += touched.has({a, b, 1.0 - a - b}) ? 1 : 0;
        }
      }
      sum += area * within / (kParts * (kParts + 1) / 2);
    }
    return sum;
  }

 private:
  void add(double radius, double angle) {
    rest_.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                       kRadius - std::sqrt(kRadius * kRadius - radius * radius));
  }
  std::vector<Vector3> rest_;
  std::vector<int> nodes_;
  std::vector<double> areas_;
  std::vector<std::array<int, 3>> triangles_;
};

/// Of a ball that nothing deforms: the cap whose height over the table is at most the tolerance.
double cap(double height) {
  return 2.0 * std::numbers::pi * Bowl::kRadius * std::max(0.0, Bowl::kTolerance - height);
}

TEST(AreaInContact, OfABallIsItsCapWhateverTheMesh) {
  int compared = 0;
  for (const double side : {1e-3, 2e-3, 3e-3}) {
    const Bowl bowl(side);
    for (double height = -5e-4; height < 0.0; height += 1e-5) {
      if (cap(height) < 1.5 * side * side) continue;  // between two samples
      const double part = 0.03 + 0.02 * side * side / 1e-6;
      EXPECT_NEAR(bowl.at(height).contact_area, cap(height), part * cap(height) + 0.4e-6)
          << side << " " << height;
      ++compared;
    }
  }
  EXPECT_GT(compared, 80);
}

TEST(AreaInContact, GrowsSmoothlyFromNothing) {
  const Bowl bowl(3e-3);
  double last = 0.0;
  EXPECT_EQ(bowl.at(1e-3).contact_area, 0.0);
  for (double height = 6e-5; height > -5e-4; height -= 1e-6) {
    const double area = bowl.at(height).contact_area;
    EXPECT_GE(area, last - 1e-12) << height;
    EXPECT_LE(area - last, 0.25e-6) << height;
    last = area;
  }
  EXPECT_GT(last, 20e-6);
}

// Where the places are is what the area is made of; a flat triangle has a little less of it.
TEST(AreaInContact, IsThatOfThePlacesInContact) {
  const Bowl bowl(2e-3);
  for (const double height : {-5e-5, -1.5e-4, -3e-4, -5e-4}) {
    const ContactSet set = bowl.at(height);
    ASSERT_GT(set.contact_area, 2e-6);
    EXPECT_NEAR(bowl.area_of_places(set), set.contact_area, 0.03 * set.contact_area) << height;
  }
  EXPECT_EQ(bowl.area_of_places(bowl.at(1e-3)), 0.0);
}

TEST(AreaInContact, SkinFacesAwayFromTheCentreOfItsBall) {
  const ContactSet set = Bowl(2e-3).at(0.0);
  const Vector3 centre(0.0, 0.0, Bowl::kRadius);
  for (std::size_t i = 0; i < 19; ++i) {  // those inside
    const Vector3 away = (set.samples[i].position_F - centre).normalized();
    EXPECT_GT(set.samples[i].skin_normal_F.dot(away), std::cos(0.02)) << i;
    EXPECT_NEAR(set.samples[i].skin_normal_F.norm(), 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace softfinger
