#include "softfinger/engine/live_twin.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/engine/live_session.hpp"

namespace softfinger {
namespace {

const std::filesystem::path kSource = SOFTFINGER_SOURCE_DIR;

/// Waits for the next press, for as long as a test may take.
bool next_press(LiveTwin& twin) {
  for (int i = 0; i < 20000; ++i) {
    if (twin.refresh()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

TickRecord command(const Device& device, double travel) {
  TickRecord tick;
  tick.command.configuration = device.home();
  tick.command.configuration[2] = travel;
  return tick;
}

// Where the virtual contact is what the twin feels itself, it finds no difference.
TEST(LiveTwin, JudgesItsPressAgainstTheContactOffered) {
  const auto model = FingerModel::load(kSource / "fingers/index.toml");
  const auto device = load_device(kSource / "devices/thimble-3rrs.toml");
  const TickRecord tick = command(*device, 4 * mm);
  Twin reference(model, device);
  ContactSet contact = reference.contact();
  contact.friction_coefficient = 0.5;
  reference.press(tick.command.configuration, 0.5, 0.0);
  const ContactSet free = contact;
  contact = reference.contact();
  ASSERT_GT(contact.contact_count, 3);

  LiveTwin twin(model, device);
  EXPECT_FALSE(twin.latest().pressed);
  ASSERT_EQ(twin.latest().skin.in_contact.size(), contact.samples.size());
  twin.start();
  twin.offer(tick, contact);
  ASSERT_TRUE(next_press(twin));
  const Snapshot::Twin& same = twin.latest();
  EXPECT_TRUE(same.pressed);
  EXPECT_EQ(same.normal_force, contact.normal_force);
  EXPECT_EQ(same.measures.iou, 1.0);
  EXPECT_EQ(same.measures.centroid_shift, 0.0);
  EXPECT_EQ(same.measures.normal_force_error, 0.0);
  for (std::size_t i = 0; i < contact.samples.size(); ++i) {
    EXPECT_EQ(same.skin.in_contact[i] != 0, contact.samples[i].in_contact);
  }

  twin.offer(tick, free);  // the device presses where nothing is
  ASSERT_TRUE(next_press(twin));
  EXPECT_EQ(twin.latest().measures.kind, FrameKind::kFalse);
  EXPECT_EQ(twin.latest().measures.iou, 0.0);

  twin.offer(command(*device, -2 * mm), free);  // and lets go
  ASSERT_TRUE(next_press(twin));
  EXPECT_EQ(twin.latest().measures.kind, FrameKind::kFree);
  EXPECT_EQ(twin.latest().normal_force, 0.0);
}

TEST(LiveTwin, EndsWithoutEverBeingAsked) {
  LiveTwin twin(FingerModel::load(kSource / "fingers/index.toml"),
                load_device(kSource / "devices/thimble-3rrs.toml"));
  twin.start();
}

/// The firmest twin that snapshots of two seconds on a sphere show.
Snapshot::Twin firmest_twin(bool wanted, bool& described) {
  RunOptions options;
  options.scene = kSource / "scenes/sphere.toml";
  options.port = "emulator";
  options.duration = 2.0;
  options.twin = wanted;
  LiveSession session(options, false);
  described = session.description()->fingers[0].twin;
  Snapshot::Twin firmest;
  std::atomic<bool> stop{false};
  std::atomic<bool> done{false};
  std::thread viewer([&] {
    while (!done.load()) {
      if (session.refresh()) {
        const Snapshot::Twin& twin = session.latest().fingers[0].twin;
        if (twin.pressed && twin.normal_force >= firmest.normal_force) firmest = twin;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  session.run(stop);
  done.store(true);
  viewer.join();
  return firmest;
}

TEST(LiveTwin, IsSeenInALiveRun) {
  bool described = false;
  const Snapshot::Twin twin = firmest_twin(true, described);
  EXPECT_TRUE(described);
  EXPECT_TRUE(twin.pressed);
  EXPECT_GT(twin.normal_force, 0.1);
  EXPECT_GT(twin.contact_area, 10 * mm2);
  EXPECT_GT(twin.measures.iou, 0.3);
  EXPECT_LE(twin.measures.iou, 1.0);
}

TEST(LiveTwin, CanBeLeftOut) {
  bool described = true;
  const Snapshot::Twin twin = firmest_twin(false, described);
  EXPECT_FALSE(described);
  EXPECT_FALSE(twin.pressed);
}

}  // namespace
}  // namespace softfinger
