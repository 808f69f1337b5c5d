// What a host program may get wrong: each is told by a status and a line, and does no harm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstring>
#include <filesystem>
#include <limits>
#include <thread>

#include "../support/temporary_directory.hpp"
#include "poses.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

constexpr double kInfinite = std::numeric_limits<double>::infinity();

struct Creation {
  sf_status status;
  std::string error;
};
Creation create(const char* scene, const sf_options* options = nullptr) {
  sf_rendering* rendering = nullptr;
  char error[512] = "as before";
  const sf_status status = sf_rendering_create(scene, options, &rendering, error, sizeof error);
  EXPECT_EQ(rendering == nullptr, status != SF_DONE);
  sf_rendering_destroy(rendering);
  EXPECT_THAT(error, testing::Not(HasSubstr("\n")));
  return {status, error};
}

sf_options sized_options() {
  sf_options options = {};
  options.size = sizeof options;
  return options;
}

TEST(CInterfaceRefuses, ScenesThatFail) {
  const std::string plane = shipped_scene("plane.toml");
  EXPECT_EQ(create(nullptr).status, SF_BAD_INPUT);
  EXPECT_EQ(create("/no/such/scene.toml").status, SF_BAD_INPUT);
  EXPECT_THAT(create("/no/such/scene.toml").error, HasSubstr("/no/such/scene.toml"));
  EXPECT_EQ(create(plane.c_str()).status, SF_DONE);
  EXPECT_EQ(create(plane.c_str()).error, "");
  sf_options options = sized_options();
  options.finger = "thumb";
  EXPECT_EQ(create(plane.c_str(), &options).status, SF_BAD_INPUT);
  EXPECT_THAT(create(plane.c_str(), &options).error, HasSubstr("no finger named thumb"));
  EXPECT_EQ(sf_rendering_create(plane.c_str(), nullptr, nullptr, nullptr, 0), SF_BAD_INPUT);
}

TEST(CInterfaceRefuses, AndCutsItsLineToTheRoomThereIs) {
  sf_rendering* rendering = nullptr;
  char error[8] = "ooooooo";
  EXPECT_EQ(sf_rendering_create("/no/such/scene.toml", nullptr, &rendering, error, 5),
            SF_BAD_INPUT);
  EXPECT_EQ(std::strlen(error), 4u);
  EXPECT_EQ(error[5], 'o');
  EXPECT_EQ(sf_rendering_create("/no/such/scene.toml", nullptr, &rendering, nullptr, 9),
            SF_BAD_INPUT);
}

TEST(CInterfaceRefuses, OptionsOfAWrongSize) {
  const std::string plane = shipped_scene("plane.toml");
  for (const std::uint32_t size : {0u, 31u, 100000u}) {
    sf_options options = sized_options();
    options.size = size;
    EXPECT_EQ(create(plane.c_str(), &options).status, SF_BAD_INPUT) << size;
    EXPECT_THAT(create(plane.c_str(), &options).error, HasSubstr("sizeof(sf_options)"));
  }
}

TEST(CInterfaceRefuses, MoreServosThanADeviceHas) {
  const std::array<double, 3> read{};
  sf_calibrate_options options = {};
  options.size = sizeof options;
  options.at = options.moved = read.data();
  const auto refused = [&](std::uint32_t count) {
    options.count = count;
    char error[512] = "";
    EXPECT_EQ(sf_device_calibrate("thimble-3rrs", "never-written.toml", &options, nullptr, 0, error,
                                  sizeof error),
              SF_BAD_INPUT);
    EXPECT_FALSE(std::filesystem::exists("never-written.toml"));
    return std::string(error);
  };
  EXPECT_EQ(refused(0xFFFFFFFFU), "count 4294967295: a device has at most 24 servos");
  EXPECT_THAT(refused(2), HasSubstr("need 3 numbers each"));
}

TEST(CInterfaceRefuses, AMissingGuardProgram) {
  sf_options options = sized_options();
  options.open_device = 1;
  options.guard_program = "/no/such/softfinger-guard";
  const Creation opened = create(shipped_scene("plane.toml").c_str(), &options);
  EXPECT_NE(opened.status, SF_DONE);
  EXPECT_THAT(opened.error, HasSubstr("guard"));
}

TEST(CInterfaceRefuses, SizesAndPointersOfSteps) {
  const OpenedScene scene("plane.toml");
  sf_pose X_WFt = touching_pose(0.0);
  sf_command command = {sizeof(sf_command)};
  EXPECT_EQ(sf_rendering_step(scene, nullptr, 0.0, &command), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_step_matrix(scene, nullptr, 0.0, &command), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_step(nullptr, &X_WFt, 0.0, &command), SF_BAD_INPUT);
  X_WFt.size = 8;
  EXPECT_EQ(sf_rendering_step(scene, &X_WFt, 0.0, &command), SF_BAD_INPUT);
  EXPECT_THAT(message_of(scene), HasSubstr("sf_pose.size"));
  X_WFt.size = sizeof X_WFt;
  command.size = 100;
  EXPECT_EQ(sf_rendering_step(scene, &X_WFt, 0.0, &command), SF_BAD_INPUT);
  EXPECT_THAT(message_of(scene), HasSubstr("sf_command.size"));
  EXPECT_EQ(sf_rendering_step(scene, &X_WFt, 0.0, nullptr), SF_DONE);
  sf_contact contact = {4};
  EXPECT_EQ(sf_rendering_contact(scene, &contact), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_contact(scene, nullptr), SF_BAD_INPUT);
  sf_info info = {4};
  EXPECT_EQ(sf_rendering_info(scene, &info), SF_BAD_INPUT);
  sf_pose small = {4, {}, {}};
  EXPECT_EQ(sf_rendering_poses(scene, &small, nullptr), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_object_pose(scene, 7, &X_WFt), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_object_name(scene, 7, nullptr, 0, nullptr), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_positions(scene, nullptr, 100, nullptr), SF_DONE);
}

TEST(CInterfaceRefuses, FingersThatAreNotThere) {
  sf_options options = {};
  options.size = sizeof options;
  options.all_fingers = 1;
  const OpenedScene two("cup.toml", &options);
  sf_pose poses[2] = {touching_pose(0.0), touching_pose(0.0)};
  EXPECT_EQ(sf_rendering_step(two, poses, 0.0, nullptr), SF_BAD_INPUT);
  EXPECT_THAT(message_of(two), HasSubstr("sf_rendering_step_fingers() takes a pose for each"));
  EXPECT_EQ(sf_rendering_step_fingers(two, poses, nullptr, 1, 0.0), SF_BAD_INPUT);
  EXPECT_THAT(message_of(two), HasSubstr("count must be the number of fingers"));
  EXPECT_EQ(sf_rendering_step_fingers(two, nullptr, nullptr, 2, 0.0), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_select(two, 2), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_command(two, nullptr), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_take_event(two, nullptr), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_object_positions(two, 9, nullptr, 0, nullptr), SF_BAD_INPUT);
  poses[1].quaternion_wxyz[0] = kNoNumber;
  EXPECT_EQ(sf_rendering_step_fingers(two, poses, nullptr, 2, 0.0), SF_BAD_INPUT);
  EXPECT_THAT(message_of(two), HasSubstr("taken as lost tracking"));
  const std::int32_t tracked[2] = {1, 0};
  EXPECT_EQ(sf_rendering_step_fingers(two, poses, tracked, 2, 0.01), SF_DONE) << "said to be lost";
  options.threads = 1000;
  EXPECT_EQ(create(shipped_scene("cup.toml").c_str(), &options).status, SF_BAD_INPUT);
}

TEST(CInterfaceRefuses, TimeThatGoesBackOrIsNone) {
  const OpenedScene scene("plane.toml");
  const sf_pose X_WFt = touching_pose(0.5);
  ASSERT_EQ(sf_rendering_step(scene, &X_WFt, 5.0, nullptr), SF_DONE);
  ASSERT_EQ(sf_rendering_step(scene, &X_WFt, 5.1, nullptr), SF_DONE);
  sf_contact before = {sizeof(sf_contact)}, after = before;
  ASSERT_EQ(sf_rendering_contact(scene, &before), SF_DONE);
  EXPECT_GT(before.normal_force_N, 0.05);
  EXPECT_EQ(sf_rendering_step(scene, &X_WFt, 5.0, nullptr), SF_BAD_INPUT);
  EXPECT_THAT(message_of(scene), HasSubstr("goes back"));
  for (const double no_time : {kNoNumber, -kInfinite, kInfinite, 1e300}) {
    EXPECT_EQ(sf_rendering_step(scene, &X_WFt, no_time, nullptr), SF_BAD_INPUT) << no_time;
  }
  EXPECT_EQ(sf_rendering_lost(scene, -1.0, nullptr), SF_BAD_INPUT);
  ASSERT_EQ(sf_rendering_contact(scene, &after), SF_DONE);
  EXPECT_EQ(std::memcmp(&before, &after, sizeof before), 0) << "nothing was done";
  EXPECT_EQ(sf_rendering_step(scene, &X_WFt, 5.1, nullptr), SF_DONE) << "the same time is no harm";
  EXPECT_EQ(sf_rendering_step(scene, &X_WFt, 5.101, nullptr), SF_DONE);
}

// As if tracking were lost: the device does not go on to be led by what is no pose.
TEST(CInterfaceRefuses, APoseThatIsNone) {
  const OpenedScene scene("plane.toml");
  sf_command command = {sizeof(sf_command)};
  double time = 0.0;
  const sf_pose good = touching_pose(0.0);
  for (; time < 1.0; time += 2e-3) sf_rendering_step(scene, &good, time, &command);
  ASSERT_EQ(command.state, SF_READY);
  sf_pose nowhere = good, no_rotation = good, far_away = good;
  far_away.position_m[0] = 1e300;
  nowhere.position_m[1] = kNoNumber;
  no_rotation.quaternion_wxyz[0] = 0.0;
  double matrix[16] = {1.0};
  for (; time < 1.5; time += 2e-3) {
    ASSERT_EQ(sf_rendering_step(scene, &nowhere, time, &command), SF_BAD_INPUT);
    ASSERT_EQ(sf_rendering_step(scene, &no_rotation, time, &command), SF_BAD_INPUT);
    ASSERT_EQ(sf_rendering_step(scene, &far_away, time, &command), SF_BAD_INPUT);
    ASSERT_EQ(sf_rendering_step_matrix(scene, matrix, time, &command), SF_BAD_INPUT);
  }
  EXPECT_THAT(message_of(scene), HasSubstr("lost tracking"));
  EXPECT_EQ(command.state, SF_RETRACTING);
}

TEST(CInterfaceRefuses, AHandleThatHasEnded) {
  sf_rendering* rendering = nullptr;
  ASSERT_EQ(
      sf_rendering_create(shipped_scene("plane.toml").c_str(), nullptr, &rendering, nullptr, 0),
      SF_DONE);
  sf_rendering_destroy(rendering);
  sf_rendering_destroy(rendering);
  const sf_pose X_WFt = touching_pose(0.0);
  sf_contact contact = {sizeof(sf_contact)};
  EXPECT_EQ(sf_rendering_step(rendering, &X_WFt, 0.0, nullptr), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_contact(rendering, &contact), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_stop(rendering), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_release(rendering), SF_BAD_INPUT);
  char error[128];
  EXPECT_EQ(sf_rendering_close_recording(rendering, error, sizeof error), SF_BAD_INPUT);
  EXPECT_THAT(error, HasSubstr("has ended"));
  EXPECT_THAT(message_of(rendering), HasSubstr("has ended"));
  EXPECT_THAT(message_of(nullptr), HasSubstr("NULL"));
  sf_rendering_destroy(nullptr);
}

TEST(CInterfaceRefuses, ASecondThreadInOneHandle) {
  const OpenedScene scene("plane.toml");
  std::atomic<bool> ended{false};
  std::atomic<int> refused{0};
  std::thread other([&] {
    while (!ended) {
      sf_contact contact = {sizeof(sf_contact)};
      if (sf_rendering_contact(scene, &contact) == SF_BAD_INPUT) {
        EXPECT_THAT(message_of(scene), HasSubstr("another thread"));
        ++refused;
      }
      std::this_thread::yield();
    }
  });
  // Whole tenths of a second at once, so that the other comes in between for sure.
  int done = 0;
  for (int i = 0; i < 1000 && (refused == 0 || done == 0); ++i) {
    const sf_pose X_WFt = touching_pose(0.5);
    const sf_status status = sf_rendering_step(scene, &X_WFt, 0.1 * i, nullptr);
    if (status == SF_DONE) ++done;
  }
  ended = true;
  other.join();
  EXPECT_GT(refused, 0);
  EXPECT_GT(done, 0);
}

TEST(CInterfaceRefuses, WhoComesAfterAnEndThatCameDuringACall) {
  sf_rendering* rendering = nullptr;
  ASSERT_EQ(
      sf_rendering_create(shipped_scene("plane.toml").c_str(), nullptr, &rendering, nullptr, 0),
      SF_DONE);
  std::atomic<bool> begun{false};
  std::thread stepping([&] {
    sf_status status = SF_DONE;
    for (int i = 0; status == SF_DONE; ++i) {
      const sf_pose X_WFt = touching_pose(0.5);
      status = sf_rendering_step(rendering, &X_WFt, 0.1 * i, nullptr);
      begun = true;
    }
    EXPECT_THAT(message_of(rendering), HasSubstr("has ended"));
  });
  while (!begun) std::this_thread::yield();
  sf_rendering_destroy(rendering);
  stepping.join();
}

// A program that was compiled against the first header.
TEST(CInterface, WritesNoFurtherThanAnOlderProgramHasRoom) {
  const OpenedScene scene("plane.toml");
  const sf_pose X_WFt = touching_pose(0.0);
  sf_command command;
  std::memset(&command, 0x5a, sizeof command);
  command.size = offsetof(sf_command, stopped);
  ASSERT_EQ(sf_rendering_step(scene, &X_WFt, 0.0, &command), SF_DONE);
  EXPECT_EQ(command.size, offsetof(sf_command, stopped));
  EXPECT_EQ(command.joint_count, 3u);
  EXPECT_EQ(command.joints[255], 0.0);
  EXPECT_EQ(command.stopped, 0x5a5a5a5a);
  sf_contact contact;
  std::memset(&contact, 0x5a, sizeof contact);
  contact.size = offsetof(sf_contact, normal_force_sum_N);
  ASSERT_EQ(sf_rendering_contact(scene, &contact), SF_DONE);
  EXPECT_EQ(contact.normal_force_N, 0.0);
  std::uint64_t beyond = 0;
  std::memcpy(&beyond, &contact.normal_force_sum_N, sizeof beyond);
  EXPECT_EQ(beyond, 0x5a5a5a5a5a5a5a5aull);
  sf_options options;
  std::memset(&options, 0x5a, sizeof options);
  options.size = offsetof(sf_options, guard_program);
  options.finger = options.device = nullptr;
  options.open_device = 0;
  EXPECT_EQ(create(shipped_scene("plane.toml").c_str(), &options).status, SF_DONE);
}

TEST(CInterface, SaysItsVersionAndStatusesInWords) {
  EXPECT_LT(sf_version(), 0x02000000u);
  EXPECT_GE(sf_version(), 0x00000100u);
  EXPECT_STREQ(sf_status_text(SF_DONE), "done");
  EXPECT_STREQ(sf_status_text(SF_FAILED), "failed");
  EXPECT_STREQ(sf_status_text(SF_BAD_INPUT), "bad input");
}

}  // namespace
}  // namespace softfinger
