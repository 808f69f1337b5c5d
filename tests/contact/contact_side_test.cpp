#include "softfinger/contact/contact_side.hpp"

#include <gtest/gtest.h>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

const Shape kBall = Ball{12 * mm};

// However wild the way: what only passes by has no side, of the ball or of anywhere else.
TEST(ContactSide, AWayThatLeavesAtAFlatAngleMeetsNothing) {
  int looked = 0;
  for (const double height : {1e-6, 1e-5, 1e-4}) {
    for (const double slope : {0.0, 0.01, 0.1, 1.0}) {
      for (const double length : {1 * mm, 20 * mm, 1.0}) {
        const Vector3 from(0.0, 0.0, 12 * mm + height);
        const Vector3 to = from + length * Vector3(1.0, 0.0, slope);
        const SignedDistance at = signed_distance(kBall, to);
        looked += may_have_passed(kBall, from, to, at) ? 1 : 0;
        EXPECT_FALSE(side_on_way(kBall, from, to).known)
            << height << " m above, " << slope << " up, " << length << " m long";
      }
    }
  }
  EXPECT_GT(looked, 20) << "of most of them a step would look";
}

TEST(ContactSide, AWayThatMeetsHasTheSideWhereItGoesIn) {
  for (const double down : {0.1, 0.3, 1.0, 10.0}) {
    // To a point of the ball's upper side and on through it.
    const Vector3 direction = Vector3(1.0, 0.0, -down).normalized();
    const Vector3 met = 12 * mm * Vector3(0.0, 0.6, 0.8);
    const ContactSide side =
        side_on_way(kBall, met - 2 * mm * direction, met + 30 * mm * direction);
    ASSERT_TRUE(side.known) << down;
    EXPECT_LT((side.point_O - met).norm(), 5e-6) << down;
    EXPECT_LT((side.normal_O - met.normalized()).norm(), 1e-3) << down;
  }
}

}  // namespace
}  // namespace softfinger
