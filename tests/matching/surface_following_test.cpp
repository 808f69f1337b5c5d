#include "softfinger/matching/surface_following.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "../support/folders.hpp"
#include "pad.hpp"
#include "softfinger/matching/skin_points.hpp"

namespace softfinger {
namespace {

constexpr double kTick = 1.0 / 30.0;

/// The contact set of a pad against a plane at `height` over its lowest point, unit normal in F.
ContactSet plane_contact(const Pad& rest, const Vector3& normal, double height) {
  double lowest = 1.0;
  for (const Vector3& p : rest.points) lowest = std::min(lowest, normal.dot(p));
  const Pad pad = press_plane(rest, (lowest - height) * normal, normal);
  ContactSet contact;
  contact.samples.resize(pad.points.size());
  for (std::size_t i = 0; i < pad.points.size(); ++i) {
    ContactSample& sample = contact.samples[i];
    sample.position_F = pad.points[i];
    sample.normal_F = normal;
    sample.gap = pad.gaps[i];
    sample.in_contact = pad.in_contact[i] != 0 && height < 0.0;
    sample.normal_force = sample.in_contact ? 0.1 : 0.0;
    sample.rest_area = sample.area = pad.areas[i];
    contact.contact_count += sample.in_contact ? 1 : 0;
    if (sample.gap < contact.least_gap) {
      contact.least_gap = sample.gap;
      contact.nearest_normal_F = normal;
    }
  }
  return contact;
}

/// The thimble, with this much of a turn on the skin, rad/s.
std::shared_ptr<const Device> device_with_turn_on_skin(double rate) {
  std::ifstream shipped(source_folder() + "/devices/thimble-3rrs.toml");
  std::stringstream text;
  text << shipped.rdbuf();
  std::string content = text.str();
  const std::string table = "[matching]\n";
  content.insert(content.find(table) + table.size(),
                 "turn_on_skin_deg_per_s = " + std::to_string(rate / deg) + "\n");
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) /
                                     ("turn_on_skin_" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << content;
  return load_device(file);
}

Vector3 tilted_normal(double tilt_deg, double azimuth_deg) {
  return {std::sin(tilt_deg * deg) * std::cos(azimuth_deg * deg),
          std::sin(tilt_deg * deg) * std::sin(azimuth_deg * deg), std::cos(tilt_deg * deg)};
}

double least_gap(const ContactSet& contact, const Configuration& q) {
  double least = 1.0;
  for (const ContactSample& sample : contact.samples) {
    least = std::min(least, thimble()->signed_distance(q, sample.position_F).distance);
  }
  return least;
}

TEST(SurfaceFollowing, HomeWhileNothingIsNear) {
  std::mt19937 random(1);
  const Pad rest = resting_pad(117, random);
  SurfaceFollowing rendering(thimble(), rest.size());
  for (int i = 0; i < 5; ++i) {
    const RenderedSurface& rendered =
        rendering.tick(plane_contact(rest, Vector3::UnitZ(), 10.0 * mm), kTick);
    EXPECT_EQ(rendered.configuration, thimble()->home());
    EXPECT_EQ(rendered.state, RenderingState::kHome);
  }
  ContactSet nothing = plane_contact(rest, Vector3::UnitZ(), 10.0 * mm);
  nothing.least_gap = std::numeric_limits<double>::infinity();
  EXPECT_EQ(rendering.tick(nothing, kTick).configuration, thimble()->home());
}

TEST(SurfaceFollowing, KeepsTheLeastGapFacingTheNearestNormal) {
  std::mt19937 random(2);
  const Pad rest = resting_pad(117, random);
  for (const double azimuth : {0.0, 130.0, 250.0}) {
    const Vector3 normal = tilted_normal(12.0, azimuth);
    SurfaceFollowing rendering(thimble(), rest.size());
    ContactSet contact;
    for (int i = 0; i < 60; ++i) {
      contact = plane_contact(rest, normal, 1.4 * mm);
      rendering.tick(contact, kTick);
    }
    const RenderedSurface& rendered = rendering.latest();
    EXPECT_EQ(rendered.state, RenderingState::kApproaching);
    EXPECT_LT((thimble()->surface_pose(rendered.configuration).rotation.col(2) - normal).norm(),
              1e-9);
    EXPECT_NEAR(least_gap(contact, rendered.configuration), 1.4 * mm, 1e-8);
  }
}

// A finger goes down on a plane that is tilted against it, presses, and leaves.
TEST(SurfaceFollowing, TouchAndReleaseDoNotJump) {
  std::mt19937 random(3);
  for (const double tilt : {0.0, 5.0, 12.0}) {
    const Pad rest = resting_pad(117, random);
    const Vector3 normal = tilted_normal(tilt, 40.0);
    SurfaceFollowing rendering(thimble(), rest.size());
    Configuration last = thimble()->home();
    double last_height = 8.0 * mm;
    RenderingState last_state = RenderingState::kHome;
    double most_travel = 0.0;
    double most_tilt = 0.0;
    for (int tick = 0; tick <= 240; ++tick) {
      const double time = tick * kTick;
      const double height = (3.2 + 4.8 * std::cos(2.0 * std::numbers::pi * time / 8.0)) * mm;
      const ContactSet contact = plane_contact(rest, normal, height);
      const RenderedSurface& rendered = rendering.tick(contact, kTick);
      EXPECT_TRUE(thimble()->reachable(rendered.configuration));
      const bool on_skin = rendered.state == RenderingState::kTouching ||
                           rendered.state == RenderingState::kLingering;
      const bool was_on_skin =
          last_state == RenderingState::kTouching || last_state == RenderingState::kLingering;
      if (on_skin || was_on_skin) {
        const double bone = std::abs(height - last_height);
        most_travel = std::max(most_travel, std::abs(rendered.configuration[2] - last[2]) - bone);
        most_tilt = std::max(most_tilt, (rendered.configuration - last).head(2).norm());
      }
      if (rendered.state == RenderingState::kApproaching) {
        EXPECT_GT(least_gap(contact, rendered.configuration), -1e-9);
      }
      last = rendered.configuration;
      last_height = height;
      last_state = rendered.state;
    }
    // A turn of 1.2 degrees about the rim raises the centre by 0.17 mm.
    EXPECT_LT(most_travel, 0.2 * mm) << tilt;
    EXPECT_LT(most_tilt, 2.0 * deg) << tilt;
    EXPECT_EQ(last_state, RenderingState::kHome);
    EXPECT_LT((last - thimble()->home()).norm(), 1e-9);
  }
}

// A tap: from out of reach into the skin between two ticks, and out again.
TEST(SurfaceFollowing, ATapIsTouchedAndLeftAtOnce) {
  std::mt19937 random(11);
  const Pad rest = resting_pad(117, random);
  for (const double approach_from : {12.0, 5.0, 2.0, 0.4}) {
    for (const double tilt : {0.0, 6.0}) {
      const Vector3 normal = tilted_normal(tilt, 0.0);
      SurfaceFollowing rendering(thimble(), rest.size());
      for (int i = 0; i < 30; ++i) {
        rendering.tick(plane_contact(rest, normal, approach_from * mm), kTick);
      }
      ContactSet contact = plane_contact(rest, normal, -1.0 * mm);
      ASSERT_GT(contact.contact_count, 3);
      rendering.tick(contact, kTick);
      const RenderedSurface& touching = rendering.tick(contact, kTick);
      EXPECT_EQ(touching.state, RenderingState::kTouching);
      EXPECT_LT(least_gap(contact, touching.configuration), 0.01 * mm) << approach_from;
      EXPECT_GT(least_gap(contact, touching.configuration), -0.2 * mm) << approach_from;
      contact = plane_contact(rest, normal, 1.0 * mm);
      EXPECT_GT(least_gap(contact, rendering.tick(contact, kTick).configuration), -1e-9)
          << "pressed on after " << approach_from;
    }
  }
}

// However far an object is, and the device from it: nothing is pressed before it touches.
TEST(SurfaceFollowing, NothingIsPressedWhileNothingTouches) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> height(0.0, 14.0);
  const Pad rest = resting_pad(117, random);
  SurfaceFollowing rendering(thimble(), rest.size());
  for (int i = 0; i < 300; ++i) {
    const bool touches = i % 7 == 0;
    const ContactSet contact =
        plane_contact(rest, tilted_normal(10.0, 25.0 * i), (touches ? -1.0 : height(random)) * mm);
    const RenderedSurface& rendered = rendering.tick(contact, kTick);
    if (!touches) {
      EXPECT_GT(least_gap(contact, rendered.configuration), -1e-8) << i;
    }
  }
}

TEST(SurfaceFollowing, LeavesTheSkinOnlyAfterTwoTicksWithoutContact) {
  std::mt19937 random(4);
  const Pad rest = resting_pad(117, random);
  SurfaceFollowing rendering(thimble(), rest.size());
  for (int i = 0; i < 40; ++i)
    rendering.tick(plane_contact(rest, Vector3::UnitZ(), -1.0 * mm), kTick);
  EXPECT_EQ(rendering.latest().state, RenderingState::kTouching);
  const ContactSet off = plane_contact(rest, Vector3::UnitZ(), 0.5 * mm);
  EXPECT_EQ(rendering.tick(off, kTick).state, RenderingState::kLingering);
  EXPECT_EQ(rendering.tick(off, kTick).state, RenderingState::kLingering);
  EXPECT_LT(least_gap(off, rendering.latest().configuration), 1e-9);
  EXPECT_EQ(rendering.tick(off, kTick).state, RenderingState::kApproaching);
  // Contact between two losses starts the count again.
  rendering.tick(plane_contact(rest, Vector3::UnitZ(), -1.0 * mm), kTick);
  EXPECT_EQ(rendering.tick(off, kTick).state, RenderingState::kLingering);
}

TEST(SurfaceFollowing, ClearsASkinThatHangsLow) {
  std::mt19937 random(5);
  Pad rest = resting_pad(117, random);
  for (Vector3& p : rest.points) p.z() -= 3.5 * mm;
  SurfaceFollowing rendering(thimble(), rest.size());
  ContactSet contact;
  for (int i = 0; i < 100; ++i) {
    contact = plane_contact(rest, Vector3::UnitZ(), 20.0 * mm);
    rendering.tick(contact, kTick);
  }
  EXPECT_NEAR(least_gap(contact, rendering.latest().configuration), 0.2 * mm, 1e-8);
}

TEST(SurfaceFollowing, SameInputSameBits) {
  std::mt19937 random(6);
  const Pad rest = resting_pad(117, random);
  SurfaceFollowing a(thimble(), rest.size());
  SurfaceFollowing b(thimble(), rest.size());
  for (int i = 0; i < 100; ++i) {
    const ContactSet contact =
        plane_contact(rest, tilted_normal(10.0, 3.0 * i), 3.0 * mm * std::cos(0.1 * i));
    EXPECT_EQ(a.tick(contact, kTick).configuration, b.tick(contact, kTick).configuration);
  }
  b.reset();
  a.reset();
  const ContactSet contact = plane_contact(rest, Vector3::UnitZ(), 1.0 * mm);
  EXPECT_EQ(a.tick(contact, kTick).configuration, b.tick(contact, kTick).configuration);
}

/// How far a thimble has turned on the skin, a time after the plane that it touches leaned over at
/// once, deg; at most what it still lacks.
double turned_after(double time, double tick_rate, int samples, double turn_on_skin) {
  std::mt19937 random(13);
  const Pad rest = resting_pad(samples, random);
  const auto device = device_with_turn_on_skin(turn_on_skin);
  SurfaceFollowing rendering(device, rest.size());
  ContactSurfaceMatching matching(device, rest.size() + 64);
  SkinPoints points(rest.size());
  for (int i = 0; i < 60; ++i) {
    rendering.tick(plane_contact(rest, Vector3::UnitZ(), -1.2 * mm), 1.0 / tick_rate);
  }
  const ContactSet turned = plane_contact(rest, tilted_normal(10.0, 0.0), -1.2 * mm);
  EXPECT_GT(turned.contact_count, 8);
  for (int i = 0; i < std::lround(time * tick_rate); ++i) {
    const RenderedSurface& rendered = rendering.tick(turned, 1.0 / tick_rate);
    EXPECT_NEAR(rendered.deviation,
                matching.deviation(points.take(turned), {}, rendered.configuration),
                1e-12 * rendered.deviation + 1e-20);
  }
  return rendering.latest().configuration[0] / deg;
}

// So many degrees a second, whatever the mesh and however often the device ticks; and E is that of
// what is rendered, not of what would be.
TEST(SurfaceFollowing, TurnsOnTheSkinAtOneRateOnAnyMeshAndAtAnyTickRate) {
  for (const double rate : {36.0, 18.0}) {
    for (const double ticks : {30.0, 60.0, 300.0}) {
      for (const int samples : {60, 120, 480}) {
        EXPECT_NEAR(turned_after(0.1, ticks, samples, rate * deg), 0.1 * rate, 1e-6)
            << ticks << " Hz, " << samples << " samples";
      }
    }
  }
  EXPECT_NEAR(turned_after(1.0, 30.0, 120, 36.0 * deg), 10.0, 0.5) << "and no further";
}

// A plane comes, presses and goes, a tenth of a millimetre a tick: no device jumps, none leaves its
// workspace, and all come home.
TEST(SurfaceFollowing, EveryKindFollowsWithoutJumps) {
  std::mt19937 random(9);
  const Pad rest = resting_pad(117, random);
  int devices = 0;
  for (const auto& file : std::filesystem::directory_iterator(source_folder() + "/devices")) {
    if (file.path().extension() != ".toml") continue;
    const auto device = load_device(file.path());
    // Files that differ by their motors alone move as one.
    if (device->settings().transport && device->settings().transport->kind != "maestro") continue;
    SurfaceFollowing rendering(device, rest.size());
    Configuration before = device->home();
    double farthest = 0.0;
    double most = 0.0;
    bool touched = false;
    for (int i = 0; i <= 200; ++i) {
      const double height = (0.1 * std::abs(i - 60) - 1.0) * mm;
      const RenderedSurface& rendered =
          rendering.tick(plane_contact(rest, Vector3::UnitZ(), height), kTick);
      ASSERT_TRUE(device->reachable(rendered.configuration)) << file.path();
      farthest = std::max(
          farthest, std::sqrt(device->squared_distance(rendered.configuration, device->home())));
      for (int k = 0; k < before.size(); ++k) {
        most = std::max(most, device->axes()[static_cast<std::size_t>(k)].metric *
                                  std::abs(rendered.configuration[k] - before[k]));
      }
      before = rendered.configuration;
      touched = touched || rendered.state == RenderingState::kTouching;
    }
    EXPECT_TRUE(touched);
    EXPECT_GT(farthest, 0.4 * mm) << file.path();
    // A tip goes to the sample that touches first, a pin rises when the contact spreads to it.
    EXPECT_LT(most, 1.6 * mm) << file.path();
    EXPECT_LT(device->squared_distance(before, device->home()), 1e-12) << file.path();
    ++devices;
  }
  EXPECT_GE(devices, 10);
}

}  // namespace
}  // namespace softfinger
