#include "softfinger/objectives/objective_kinds.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string_view>

#include "../support/folders.hpp"
#include "pressed_finger.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/matching/packed_samples.hpp"
#include "softfinger/matching/skin_points.hpp"

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
  EXPECT_EQ(objective_kind("contact_plane"), objective_kind("plane")) << "a name it had";
  EXPECT_EQ(objective_kind("fun"), nullptr);
  EXPECT_EQ(objective_kind(""), nullptr);
}

// Recordings have them for good.
TEST(ObjectiveKinds, NumbersNeverChange) {
  const std::map<std::string_view, double> kept{{"surface", 0.0},
                                                {"surface_and_force", 1.0},
                                                {"stress", 2.0},
                                                {"published", 3.0},
                                                {"plane", 4.0}};
  for (const auto& [name, number] : kept) {
    EXPECT_EQ(number_of(*objective_kind(name)), number) << name;
    EXPECT_EQ(objective_numbered(number), objective_kind(name)) << name;
  }
  for (const double number : {-1.0, 0.5, 99.0, 1e300, std::nan("")}) {
    EXPECT_EQ(objective_numbered(number), nullptr) << number;
  }
}

TEST(ObjectiveKinds, AShippedDeviceCanHaveEach) {
  for (const auto& file : std::filesystem::directory_iterator(source_folder() + "/devices")) {
    if (file.path().extension() != ".toml") continue;
    const auto device = load_device(file.path());
    for (const ObjectiveKind& kind : objective_kinds()) EXPECT_EQ(why_not(kind, *device), "");
  }
}

TEST(ObjectiveKinds, AnEmptyFileLeadsByTheSurface) {
  EXPECT_EQ(MatchingSettings().objective, "surface");
  EXPECT_EQ(&objective_kind(*device_of("pins-wagner-6x6")), objective_kind("surface"));
  EXPECT_EQ(&objective_kind(*device_of("thimble-3rrs")), objective_kind("surface_and_force"));
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
    const VirtualFinger finger = held().finger();
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

TEST(PlaneObjective, GoesThroughTheCentroidAlongTheMeanNormal) {
  const auto device = device_of("thimble-3rrs");
  const auto objective = objective_kind("plane")->make(held().model, device);
  const RenderedSurface& rendered = objective->tick(held().finger(), kTick);
  const Pose X_FP = device->surface_pose(rendered.configuration);
  const Vector3 centroid_P =
      X_FP.rotation.transpose() * (held().contact.centroid_F - X_FP.translation);
  EXPECT_NEAR(centroid_P.z(), 0.0, 1e-8);
  EXPECT_GT(X_FP.rotation.col(2).dot(held().contact.mean_normal_F), std::cos(0.1 * deg));
}

/// E of the held finger's contact at q.
double held_deviation(const Device& device, const MatchingOptions& options,
                      const Configuration& q) {
  const int samples = static_cast<int>(held().model->sample_nodes.size());
  SkinPoints points(samples);
  PackedSamples packed(samples + static_cast<int>(ContactSet::kMostFeatures));
  return device.deviation(q, packed.pack(points.take(held().contact), options,
                                         device.settings().matching.separation_tolerance));
}

// What a device is held to is what is told of it, easing and all.
TEST(ObjectiveKinds, EachTellsTheDeviationOfWhatItRenders) {
  const auto device = device_of("thimble-3rrs");
  for (const ObjectiveKind& kind : objective_kinds()) {
    const auto objective = kind.make(held().model, device);
    MatchingOptions options;
    if (kind.name == "published") options.separation = Separation::kConstant;
    for (int tick = 0; tick < 3; ++tick) {
      const RenderedSurface rendered = objective->tick(held().finger(), 1e-3);
      const double deviation = held_deviation(*device, options, rendered.configuration);
      EXPECT_GT(deviation, 0.0) << kind.name;
      EXPECT_NEAR(rendered.deviation, deviation, 1e-9 * deviation) << kind.name << " " << tick;
      objective->follow(rendered.configuration);
    }
  }
}

// Nothing but the minimum that the last answer leads to: where the skin has left it stays, clear of
// it, and comes back from there.
TEST(Published, KnowsNothingButItsLastAnswer) {
  const auto device = device_of("thimble-3rrs");
  const auto published = objective_kind("published")->make(held().model, device);
  const Configuration pressed = published->tick(held().finger(), kTick).configuration;
  EXPECT_GT(pressed[2], device->home()[2] + 3.0 * mm);
  ContactSet off = held().contact;
  for (ContactSample& sample : off.samples) {
    sample.in_contact = false;
    sample.gap = std::max(0.0, sample.gap) + 20.0 * mm;
  }
  off.contact_count = 0;
  off.feature_count = 0;
  off.least_gap = 20.0 * mm;
  RenderedSurface left;
  for (int tick = 0; tick < 90; ++tick) {
    left = published->tick({off, held().nodes_W, held().X_WF}, kTick);
  }
  EXPECT_LT(std::sqrt(device->squared_distance(left.configuration, pressed)), 1.5 * mm);
  EXPECT_EQ(left.deviation, 0.0);
  const auto surface = objective_kind("surface")->make(held().model, device);
  surface->tick(held().finger(), kTick);
  for (int tick = 0; tick < 90; ++tick) {
    left = surface->tick({off, held().nodes_W, held().X_WF}, kTick);
  }
  EXPECT_EQ(left.configuration, device->home()) << "who retracts";
}

// However short a tick is, and from wherever it comes: no limiter.
TEST(Published, IsThereInOneTick) {
  const auto device = device_of("thimble-3rrs");
  const auto slow = objective_kind("published")->make(held().model, device);
  const auto quick = objective_kind("published")->make(held().model, device);
  EXPECT_EQ(slow->tick(held().finger(), kTick).configuration,
            quick->tick(held().finger(), 0.0).configuration);
}

}  // namespace
}  // namespace softfinger
