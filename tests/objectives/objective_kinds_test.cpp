#include "softfinger/objectives/objective_kinds.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <string_view>

#include "pressed_finger.hpp"
#include "softfinger/base/units.hpp"

// Sanitizers bring their own malloc.
#ifndef SOFTFINGER_SANITIZED
namespace {
std::atomic<long> allocations{0};
}

extern "C" void* __libc_malloc(std::size_t size);  // NOLINT: glibc's own
/// Counts what this program takes from the heap: operator new and Eigen end here.
extern "C" void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
#endif

namespace softfinger {
namespace {

const PressedFinger& held() {
  static const PressedFinger finger(1.0 * mm);
  return finger;
}

TEST(ObjectiveKinds, EachHasANameOfItsOwn) {
  EXPECT_GE(objective_kinds().size(), 5U);
  for (const ObjectiveKind& kind : objective_kinds()) {
    EXPECT_EQ(objective_kind(kind.name), &kind);
    EXPECT_FALSE(kind.words.empty()) << kind.name;
  }
  EXPECT_EQ(objective_kind("fun"), nullptr);
  EXPECT_EQ(objective_kind(""), nullptr);
}

TEST(ObjectiveKinds, AnEmptyFileLeadsByTheSurface) {
  EXPECT_EQ(MatchingSettings().objective, "surface");
  EXPECT_EQ(&objective_kind(*device_of("roller-provancher")), objective_kind("surface"));
}

TEST(ObjectiveKinds, EachStaysHomeWhereNothingIsNear) {
  ContactSet nothing;
  nothing.samples.resize(held().contact.samples.size());
  for (std::size_t i = 0; i < nothing.samples.size(); ++i) {
    nothing.samples[i].position_F = held().contact.samples[i].position_F;
  }
  for (const char* name : {"delta-schorr", "thimble-3rrs"}) {
    const auto device = device_of(name);
    for (const ObjectiveKind& kind : objective_kinds()) {
      const auto objective = kind.make(held().model, device);
      const RenderedSurface& rendered =
          objective->tick({nothing, held().nodes_W, held().X_WF}, kTick);
      EXPECT_EQ(rendered.state, RenderingState::kHome);
      EXPECT_EQ(rendered.configuration, device->home()) << kind.name << " " << name;
    }
  }
}

/// Reachable, of these joints, no two alike; and a tick takes nothing from the heap.
TEST(ObjectiveKinds, EachTouchesInItsOwnWay) {
  const auto device = device_of("thimble-3rrs");
  ASSERT_GT(held().contact.normal_force, 0.3);
  std::vector<Configuration> wanted;
  for (const ObjectiveKind& kind : objective_kinds()) {
    const auto objective = kind.make(held().model, device);
    EXPECT_EQ(objective->wants_nodes(), kind.name == "stress");
    const std::vector<Vector3> none;
    const std::vector<Vector3>& nodes_W = objective->wants_nodes() ? held().nodes_W : none;
    const VirtualFinger finger{held().contact, nodes_W, held().X_WF};
    objective->follow(objective->tick(finger, kTick).configuration);
#ifndef SOFTFINGER_SANITIZED
    const long before = allocations;
#endif
    for (int tick = 0; tick < 8; ++tick) {
      objective->follow(objective->tick(finger, kTick).configuration);
    }
#ifndef SOFTFINGER_SANITIZED
    EXPECT_EQ(allocations - before, 0) << kind.name;
#endif
    const RenderedSurface rendered = objective->tick(finger, kTick);
    EXPECT_EQ(rendered.state, RenderingState::kTouching) << kind.name;
    EXPECT_TRUE(device->reachable(rendered.configuration)) << kind.name;
    JointAngles joints;
    ASSERT_TRUE(device->inverse_kinematics(rendered.configuration, joints)) << kind.name;
    EXPECT_EQ(rendered.joints, joints) << kind.name;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      EXPECT_GT(device->squared_distance(rendered.configuration, wanted[k]), 0.0)
          << kind.name << " as " << objective_kinds()[k].name;
    }
    wanted.push_back(rendered.configuration);
  }
}

TEST(ContactPlane, GoesThroughTheCentroidAlongTheMeanNormal) {
  const auto device = device_of("thimble-3rrs");
  const auto objective = objective_kind("contact_plane")->make(held().model, device);
  const Configuration q = objective->tick(held().finger(), kTick).configuration;
  const Pose X_FP = device->surface_pose(q);
  const Vector3 centroid_P =
      X_FP.rotation.transpose() * (held().contact.centroid_F - X_FP.translation);
  EXPECT_NEAR(centroid_P.z(), 0.0, 1e-8);
  EXPECT_GT(X_FP.rotation.col(2).dot(held().contact.mean_normal_F), std::cos(0.1 * deg));
}

}  // namespace
}  // namespace softfinger
