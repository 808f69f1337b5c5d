#include "softfinger/session/live_twin.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "../support/folders.hpp"
#include "../support/scenes_without_force_limit.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/session/live_session.hpp"

namespace softfinger {
namespace {

const std::filesystem::path kProject = source_folder();

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
  const auto model = FingerModel::load(kProject / "fingers/index.toml");
  const auto device = load_device(kProject / "devices/thimble-3rrs.toml");
  const TickRecord tick = command(*device, 4 * mm);
  Twin reference(model, device);
  ContactSet contact = reference.contact();
  contact.friction_coefficient = 0.5;
  reference.press(tick.command.configuration, 0.5, 0.0);
  const ContactSet free = contact;
  contact = reference.contact();
  ASSERT_GT(contact.contact_count, 3);

  LiveTwin twin(model, model, device);
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

// A wearer of another mesh feels nearly the same, and is shown where the model's samples are.
TEST(LiveTwin, ShowsAWearerOfAnyMeshOnTheModelsSamples) {
  const auto model = FingerModel::load(kProject / "fingers/index.toml");
  const auto wearer = FingerModel::load(kProject / "fingers/index-medium.toml");
  const auto device = load_device(kProject / "devices/thimble-3rrs.toml");
  const TickRecord tick = command(*device, 4 * mm);
  Twin reference(model, device);
  reference.press(tick.command.configuration, 0.5, 0.0);
  const ContactSet& contact = reference.contact();
  ASSERT_GT(contact.contact_count, 3);
  LiveTwin twin(model, wearer, device);
  twin.start();
  twin.offer(tick, contact);
  ASSERT_TRUE(next_press(twin));
  const Snapshot::Twin& press = twin.latest();
  EXPECT_GT(press.measures.iou, 0.85);
  EXPECT_LT(press.measures.normal_force_error, 0.15);
  EXPECT_LT(press.measures.pressure_error, 0.3);
  ASSERT_EQ(press.skin.positions_F.size(), contact.samples.size());
  int alike = 0, touching = 0;
  double apart = 0.0;
  for (std::size_t i = 0; i < contact.samples.size(); ++i) {
    const Vector3 shown = press.skin.positions_F[i].cast<double>();
    apart += (shown - contact.samples[i].position_F).norm();
    if (!contact.samples[i].in_contact) continue;
    ++touching;
    alike += press.skin.in_contact[i] != 0 && press.skin.pressures[i] > 0.0F ? 1 : 0;
  }
  EXPECT_GT(alike, touching / 2);
  EXPECT_LT(apart, 0.3 * mm * static_cast<double>(contact.samples.size()));
}

TEST(LiveTwin, EndsWithoutEverBeingAsked) {
  const auto model = FingerModel::load(kProject / "fingers/index.toml");
  LiveTwin twin(model, model, load_device(kProject / "devices/thimble-3rrs.toml"));
  twin.start();
}

/// A live run on a sphere, over and over until a snapshot is wanted or, at last, none will come.
class LiveTwinSeen : public testing::Test {
 protected:
  /// The first finger of the first snapshot that `wanted` likes.
  template <typename Wanted>
  Snapshot::Finger first(bool twin, const Wanted& wanted) {
    RunOptions options;
    options.scene = scenes_.scene("sphere");
    options.actuator.port = "emulator";
    options.twin = twin;
    LiveSession session(options, true);
    described_ = session.description()->fingers[0].twin;
    Snapshot::Finger found;
    std::atomic<bool> stop{false};
    std::thread viewer([&] {
      for (int i = 0; i < 24000 && !stop.load(); ++i) {
        if (session.refresh() && wanted(session.latest().fingers[0])) {
          found = session.latest().fingers[0];
          stop.store(true);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
      stop.store(true);
    });
    session.run(stop);
    viewer.join();
    return found;
  }
  ScenesWithoutForceLimit scenes_;
  bool described_ = false;  ///< to the page
};

TEST_F(LiveTwinSeen, WhileTheDevicePresses) {
  const Snapshot::Finger finger = first(true, [](const Snapshot::Finger& seen) {
    return seen.twin.measures.kind == FrameKind::kBoth && seen.twin.normal_force > 0.1;
  });
  EXPECT_TRUE(described_);
  EXPECT_TRUE(finger.twin.pressed);
  EXPECT_GT(finger.twin.contact_area, 5 * mm2);
  EXPECT_GT(finger.twin.measures.iou, 0.0);
  EXPECT_LE(finger.twin.measures.iou, 1.0);
}

TEST_F(LiveTwinSeen, NotWhereItIsLeftOutHoweverFirmTheTouch) {
  const Snapshot::Finger finger =
      first(false, [](const Snapshot::Finger& seen) { return seen.normal_force > 0.5; });
  EXPECT_FALSE(described_);
  EXPECT_GT(finger.normal_force, 0.5);
  EXPECT_FALSE(finger.twin.pressed);
  EXPECT_TRUE(finger.twin.skin.positions_F.empty());
}

}  // namespace
}  // namespace softfinger
