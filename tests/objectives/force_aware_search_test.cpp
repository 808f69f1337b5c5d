// The search of a frame, which begins with what the last one knew, against one that knows nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "../support/name_of_file.hpp"
#include "pressed_finger.hpp"
#include "softfinger/matching/surface_following.hpp"
#include "softfinger/objectives/force_aware_matching.hpp"

namespace softfinger {
namespace {

constexpr int kFrames = 4;  // in which a search has come as far as it comes

/// The finger held at 0.8, 0.9 and 1 mm.
const PressedFinger& finger_at(int tenths) {
  static const std::vector<PressedFinger> fingers = [] {
    std::vector<PressedFinger> held;
    for (const double depth : {0.8 * mm, 0.9 * mm, 1.0 * mm}) held.emplace_back(depth);
    return held;
  }();
  return fingers[static_cast<std::size_t>(tenths - 8)];
}

class Search : public testing::TestWithParam<const char*> {
 protected:
  Search()
      : device(device_of(GetParam())),
        capacity(static_cast<int>(finger_at(8).model->sample_nodes.size())) {}
  [[nodiscard]] ForceAwareMatching begin() const { return {finger_at(8).model, device, capacity}; }
  const ForceAwareResult& match(ForceAwareMatching& force, int tenths) const {
    const ContactSet& contact = finger_at(tenths).contact;
    SurfaceFollowing surface(device, capacity, {});
    const Configuration q = surface.tick(contact, 1.0).configuration;
    return force.match(contact, q, contact.friction_coefficient, kTick, {});
  }
  /// What is amiss of the normal force, as a vector, after some frames.
  [[nodiscard]] double error(ForceAwareMatching& force, int tenths) const {
    for (int frame = 1; frame < kFrames; ++frame) match(force, tenths);
    const Vector3 wanted = normal_force_vector(finger_at(tenths).contact);
    EXPECT_GT(wanted.norm(), 0.1);
    return (match(force, tenths).force - wanted).norm() / wanted.norm();
  }

  std::shared_ptr<const Device> device;
  int capacity;
};

TEST_P(Search, FindsAsMuchOfTheForceAsOneThatKnowsNothing) {
  ForceAwareMatching going_on = begin();
  for (const int tenths : {8, 9, 10, 9, 8}) {
    ForceAwareMatching anew = begin();
    EXPECT_LT(error(going_on, tenths), error(anew, tenths) + 0.02) << tenths << " tenths of a mm";
  }
}

TEST_P(Search, LeavesTheDeviceAloneWhereNothingIsAmiss) {
  ForceAwareMatching force = begin();
  static_cast<void>(error(force, 9));
  static_cast<void>(error(force, 9));
  const Configuration before = match(force, 9).configuration;
  const ForceAwareResult& after = match(force, 9);
  EXPECT_LT(std::sqrt(device->squared_distance(after.configuration, before)), 0.05 * mm);
  EXPECT_LE(after.iterations, 1);
}

INSTANTIATE_TEST_SUITE_P(ForceAware, Search,
                         testing::Values("thimble-3rrs", "plate-6dof", "pins-wagner-6x6",
                                         "membrane", "delta-schorr", "strap-minamizawa"),
                         name_of_file<const char*>);

}  // namespace
}  // namespace softfinger
