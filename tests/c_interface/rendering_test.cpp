#include "softfinger/rendering.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <optional>
#include <thread>
#include <vector>

#include "../session/loop_guard.hpp"
#include "poses.hpp"

namespace softfinger {
namespace {

std::vector<double> positions_of(const sf_rendering* rendering) {
  std::size_t count = 0;
  EXPECT_EQ(sf_rendering_positions(rendering, nullptr, 0, &count), SF_DONE);
  std::vector<double> xyz(3 * count);
  EXPECT_EQ(sf_rendering_positions(rendering, xyz.data(), count, nullptr), SF_DONE);
  return xyz;
}

TEST(CInterface, GivesTheBitsOfTheCppInterface) {
  const OpenedScene c("plane.toml"), by_matrix("plane.toml");
  Rendering cpp(shipped_scene("plane.toml"));
  sf_command command = {sizeof(sf_command)};
  double most_force = 0.0;
  for (int i = 0; i <= 500; ++i) {
    const double time = 2e-3 * i;
    const sf_pose X_WFt = touching_pose(time);
    const Pose pose = as_cpp(X_WFt);
    Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = decltype(matrix)::Identity();
    matrix.topLeftCorner<3, 3>() = pose.rotation;
    matrix.topRightCorner<3, 1>() = pose.translation;
    ASSERT_EQ(sf_rendering_step(c, &X_WFt, 3.0 + time, &command), SF_DONE) << message_of(c);
    ASSERT_EQ(sf_rendering_step_matrix(by_matrix, matrix.data(), time, nullptr), SF_DONE);
    const RenderingCommand& expected = cpp.step(pose, 3.0 + time);
    sf_contact contact = {sizeof(sf_contact)}, contact_by_matrix = contact;
    ASSERT_EQ(sf_rendering_contact(c, &contact), SF_DONE);
    ASSERT_EQ(sf_rendering_contact(by_matrix, &contact_by_matrix), SF_DONE);
    const RenderingSnapshot snapshot = cpp.snapshot();
    ASSERT_EQ(contact.normal_force_N, snapshot.normal_force);
    ASSERT_EQ(contact_by_matrix.normal_force_N, snapshot.normal_force);
    ASSERT_EQ(Vector3(contact.centroid_F_m), snapshot.centroid_F);
    ASSERT_EQ(command.tick, expected.tick);
    ASSERT_EQ(command.configuration_count, 3u);
    ASSERT_EQ(Vector3(command.configuration), Vector3(expected.configuration));
    ASSERT_EQ(Vector3(command.joints), Vector3(expected.joints));
    ASSERT_EQ(command.set_points[0], expected.set_points[0]);
    most_force = std::max(most_force, contact.normal_force_N);
  }
  EXPECT_GT(most_force, 0.1);
  EXPECT_EQ(positions_of(c).size(), 3 * cpp.snapshot().sample_positions_F.size());
  EXPECT_EQ(std::memcmp(positions_of(c).data(), cpp.snapshot().sample_positions_F.data(),
                        8 * positions_of(c).size()),
            0);
}

TEST(CInterface, WhatAProgramDraws) {
  const OpenedScene scene("plane.toml");
  for (double time : {0.0, 0.25, 0.5}) {
    const sf_pose X_WFt = touching_pose(time);
    ASSERT_EQ(sf_rendering_step(scene, &X_WFt, time, nullptr), SF_DONE);
  }
  sf_info info = {sizeof(sf_info)};
  ASSERT_EQ(sf_rendering_info(scene, &info), SF_DONE);
  EXPECT_EQ(info.simulation_rate_Hz, 1000.0);
  EXPECT_EQ(info.device_rate_Hz, 30.0);
  EXPECT_EQ(info.object_count, 1u);
  EXPECT_EQ(info.configuration_count, 3u);
  EXPECT_EQ(info.joint_count, 3u);
  std::vector<std::uint32_t> corners(3 * info.triangle_count);
  ASSERT_EQ(sf_rendering_triangles(scene, corners.data(), info.triangle_count, nullptr), SF_DONE);
  EXPECT_EQ(*std::max_element(corners.begin(), corners.end()), info.sample_count - 1);
  std::vector<std::uint8_t> in_contact(info.sample_count);
  std::vector<double> pressures(info.sample_count);
  std::size_t count = 0;
  ASSERT_EQ(sf_rendering_in_contact(scene, in_contact.data(), in_contact.size(), &count), SF_DONE);
  EXPECT_EQ(count, info.sample_count);
  ASSERT_EQ(sf_rendering_pressures(scene, pressures.data(), pressures.size(), nullptr), SF_DONE);
  EXPECT_GT(std::count(in_contact.begin(), in_contact.end(), 1), 3);
  EXPECT_GT(*std::max_element(pressures.begin(), pressures.end()), 100.0);
  sf_pose X_WFt = {sizeof(sf_pose), {}, {}}, X_WF = X_WFt, X_WO = X_WFt;
  ASSERT_EQ(sf_rendering_poses(scene, &X_WFt, &X_WF), SF_DONE);
  EXPECT_GT(X_WF.position_m[2], X_WFt.position_m[2]) << "it stays behind";
  ASSERT_EQ(sf_rendering_object_pose(scene, 0, &X_WO), SF_DONE);
  EXPECT_EQ(X_WO.quaternion_wxyz[0], 1.0);
  char name[16];
  ASSERT_EQ(sf_rendering_object_name(scene, 0, name, sizeof name, &count), SF_DONE);
  EXPECT_STREQ(name, "table");
  EXPECT_EQ(count, 6u);
  ASSERT_EQ(sf_rendering_configuration_name(scene, 2, name, sizeof name, nullptr), SF_DONE);
  EXPECT_STREQ(name, "travel_mm");
}

TEST(CInterface, AHandleForEachFinger) {
  const std::string hand = shipped_scene("hand.toml");
  char name[32], error[256];
  std::size_t count = 0;
  ASSERT_EQ(sf_scene_finger(hand.c_str(), 0, name, sizeof name, &count, error, sizeof error),
            SF_DONE);
  EXPECT_EQ(count, 5u);
  ASSERT_EQ(sf_scene_finger(hand.c_str(), 4, name, sizeof name, nullptr, nullptr, 0), SF_DONE);
  sf_options options = {};
  options.size = sizeof options;
  options.finger = name;
  const OpenedScene last("hand.toml", &options);
  EXPECT_EQ(sf_scene_finger(hand.c_str(), 5, name, sizeof name, nullptr, error, sizeof error),
            SF_BAD_INPUT);
  EXPECT_THAT(error, testing::HasSubstr("no finger 5; it has 5"));
}

// Index and thumb of the scene, on their way together: the first of the two is 4 mm deep.
TEST(CInterface, AllFingersOfASceneHoldWhatMoves) {
  sf_options options = {};
  options.size = sizeof options;
  options.all_fingers = 1;
  options.threads = 2;
  const OpenedScene cup("cup.toml", &options);
  sf_info info = {sizeof(sf_info)};
  ASSERT_EQ(sf_rendering_info(cup, &info), SF_DONE);
  ASSERT_EQ(info.finger_count, 2u);
  char name[16];
  ASSERT_EQ(sf_rendering_finger_name(cup, 1, name, sizeof name, nullptr), SF_DONE);
  EXPECT_STREQ(name, "thumb");
  EXPECT_EQ(sf_rendering_finger_name(cup, 2, name, sizeof name, nullptr), SF_BAD_INPUT);

  RenderingOptions cpp_options;
  cpp_options.all_fingers = true;
  Rendering cpp(shipped_scene("cup.toml"), cpp_options);
  sf_pose poses[2] = {{sizeof(sf_pose), {}, {0, 0, 0, 0}}, {sizeof(sf_pose), {}, {0, 0, 0, 0}}};
  const double half = std::sqrt(0.5);
  for (int i = 0; i <= 400; ++i) {
    const double time = i / 400.0;
    const double x = 46e-3 - 11e-3 * std::min(1.0, 1.25 * time);
    // Pads towards each other: turned about y, the thumb about z besides.
    poses[0] = {sizeof(sf_pose), {x, 0.0, 52e-3}, {half, 0.0, half, 0.0}};
    poses[1] = {sizeof(sf_pose), {-x, 0.0, 52e-3}, {0.0, half, 0.0, -half}};
    ASSERT_EQ(sf_rendering_step_fingers(cup, poses, nullptr, 2, time), SF_DONE) << message_of(cup);
    cpp.step(std::vector<std::optional<Pose>>{as_cpp(poses[0]), as_cpp(poses[1])}, time);
  }
  for (std::size_t finger : {0U, 1U}) {
    RenderingSnapshot expected;
    cpp.snapshot(expected, finger);
    ASSERT_EQ(sf_rendering_select(cup, finger), SF_DONE);
    sf_contact contact = {sizeof(sf_contact)};
    ASSERT_EQ(sf_rendering_contact(cup, &contact), SF_DONE);
    EXPECT_GT(contact.normal_force_N, 0.2) << finger;
    EXPECT_EQ(contact.normal_force_N, expected.normal_force) << finger;
    sf_command command = {sizeof(sf_command)};
    ASSERT_EQ(sf_rendering_command(cup, &command), SF_DONE);
    EXPECT_EQ(command.state, SF_RENDERING);
    EXPECT_EQ(Vector3(command.configuration), Vector3(cpp.command(finger).configuration));
  }
  sf_object object = {sizeof(sf_object)};
  ASSERT_EQ(sf_rendering_object(cup, 0, &object), SF_DONE);
  EXPECT_EQ(object.moves, 1);
  EXPECT_EQ(object.has_joint + object.soft, 0);
  EXPECT_EQ(sf_rendering_object(cup, 2, &object), SF_BAD_INPUT);
  std::size_t count = 7;
  ASSERT_EQ(sf_rendering_object_positions(cup, 0, nullptr, 0, &count), SF_DONE);
  EXPECT_EQ(count, 0u) << "it keeps its shape";

  int met[2] = {0, 0};
  for (sf_event event = {sizeof(sf_event)};;) {
    ASSERT_EQ(sf_rendering_take_event(cup, &event), SF_DONE);
    if (event.kind == SF_NO_EVENT) break;
    if (event.kind == SF_IMPACT && event.other_finger >= 0) ++met[event.other_finger];
  }
  EXPECT_EQ(met[0], 1);
  EXPECT_EQ(met[1], 1);
  EXPECT_STREQ(sf_event_text(SF_IMPACT), "impact");
  EXPECT_STREQ(sf_event_text(SF_NO_EVENT), "");
}

TEST(CInterface, TellsTheSurfaceOfWhatIsSoft) {
  sf_options options = {};
  options.size = sizeof options;
  options.all_fingers = 1;
  const OpenedScene scene("sponge.toml", &options);
  ASSERT_EQ(sf_rendering_lost(scene, 0.0, nullptr), SF_DONE);
  ASSERT_EQ(sf_rendering_lost(scene, 0.1, nullptr), SF_DONE);
  sf_object object = {sizeof(sf_object)};
  ASSERT_EQ(sf_rendering_object(scene, 0, &object), SF_DONE);
  EXPECT_EQ(object.soft, 1);
  std::size_t points = 0;
  std::size_t triangles = 0;
  ASSERT_EQ(sf_rendering_object_positions(scene, 0, nullptr, 0, &points), SF_DONE);
  ASSERT_EQ(sf_rendering_object_triangles(scene, 0, nullptr, 0, &triangles), SF_DONE);
  std::vector<double> xyz(3 * points);
  std::vector<std::uint32_t> corners(3 * triangles);
  ASSERT_EQ(sf_rendering_object_positions(scene, 0, xyz.data(), points, nullptr), SF_DONE);
  ASSERT_EQ(sf_rendering_object_triangles(scene, 0, corners.data(), triangles, nullptr), SF_DONE);
  ASSERT_GT(points, 100u);
  EXPECT_EQ(*std::max_element(corners.begin(), corners.end()), points - 1);
  // Six times the volume, by the divergence theorem: the sponge is 36 x 24 x 20 mm or so.
  double six = 0.0;
  for (std::size_t t = 0; t < triangles; ++t) {
    const Vector3 a(&xyz[3 * corners[3 * t]]), b(&xyz[3 * corners[3 * t + 1]]),
        c(&xyz[3 * corners[3 * t + 2]]);
    six += a.dot(b.cross(c));
  }
  EXPECT_GT(six / 6, 1.5e-5);
  EXPECT_LT(six / 6, 3e-5);
}

TEST(CInterface, AnObjectIsWhereItsHostHasIt) {
  const OpenedScene scene("plane.toml");
  const sf_pose X_WFt = {sizeof(sf_pose), {0.0, 0.0, 8.5e-3}, {1.0, 0.0, 0.0, 0.0}};
  const auto lift = [&](double height) {
    const sf_pose X_WO = {sizeof(sf_pose), {0.0, 0.0, height}, {1.0, 0.0, 0.0, 0.0}};
    return sf_rendering_move_object(scene, 0, &X_WO);
  };
  sf_pose X_WO = {sizeof(sf_pose), {}, {}};
  ASSERT_EQ(lift(-2e-3), SF_DONE) << "there from the start";
  ASSERT_EQ(sf_rendering_step(scene, &X_WFt, 0.0, nullptr), SF_DONE);
  ASSERT_EQ(sf_rendering_object_pose(scene, 0, &X_WO), SF_DONE);
  EXPECT_EQ(X_WO.position_m[2], -2e-3);
  // It moves straight until the next call, and stays.
  for (int i = 1; i <= 100; ++i) {
    ASSERT_EQ(lift(-2e-3 + 4e-5 * i), SF_DONE);
    ASSERT_EQ(sf_rendering_step(scene, &X_WFt, 0.004 * i, nullptr), SF_DONE);
  }
  ASSERT_EQ(sf_rendering_step(scene, &X_WFt, 0.5, nullptr), SF_DONE);
  ASSERT_EQ(sf_rendering_object_pose(scene, 0, &X_WO), SF_DONE);
  EXPECT_NEAR(X_WO.position_m[2], 2e-3, 1e-12);
  sf_contact contact = {sizeof(sf_contact)};
  ASSERT_EQ(sf_rendering_contact(scene, &contact), SF_DONE);
  EXPECT_GT(contact.normal_force_N, 0.2) << "it presses the finger that stays";
  EXPECT_LT(contact.normal_force_N, 20.0);

  X_WO.quaternion_wxyz[0] = 2.0;
  EXPECT_EQ(sf_rendering_move_object(scene, 0, &X_WO), SF_BAD_INPUT);
  EXPECT_THAT(message_of(scene), HasSubstr("quaternion"));
  EXPECT_EQ(sf_rendering_move_object(scene, 1, &X_WO), SF_BAD_INPUT);
  EXPECT_EQ(sf_rendering_move_object(scene, 0, nullptr), SF_BAD_INPUT);
  const OpenedScene button("button.toml");
  X_WO = {sizeof(sf_pose), {}, {1.0, 0.0, 0.0, 0.0}};
  for (std::size_t object = 0; object < 2; ++object) {
    EXPECT_EQ(sf_rendering_move_object(button, object, &X_WO), SF_BAD_INPUT)
        << "it moves by forces, or that hangs on it";
  }
}

TEST(CInterface, StepsAllocateNothing) {
  if (!guard_works()) GTEST_SKIP() << "not with a sanitizer's own malloc";
  const OpenedScene scene("plane.toml");
  sf_command command = {sizeof(sf_command)};
  const auto run = [&](double from, double to) {
    for (double time = from; time < to; time += 1e-3) {
      const sf_pose X_WFt = touching_pose(time);
      const sf_pose X_WO = {sizeof(sf_pose), {1e-3 * time, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
      sf_contact contact = {sizeof(sf_contact)};
      double xyz[300];
      sf_rendering_move_object(scene, 0, &X_WO);
      sf_rendering_step(scene, &X_WFt, time, &command);
      sf_rendering_contact(scene, &contact);
      sf_rendering_positions(scene, xyz, 100, nullptr);
    }
  };
  run(0.0, 0.2);
  reset_guard();
  std::thread([&] {
    guard_this_thread();
    run(0.2, 0.8);
  }).join();
  EXPECT_EQ(guard_counts().threads, 1u);
  EXPECT_EQ(guard_counts().allocations, 0u);
  EXPECT_EQ(guard_counts().locks, 0u);
  EXPECT_GT(command.tick, 20);
}

TEST(CInterface, AStopLastsUntilItIsReleased) {
  const OpenedScene scene("plane.toml");
  EXPECT_EQ(sf_rendering_release(scene), SF_FAILED);
  EXPECT_THAT(message_of(scene), testing::HasSubstr("nothing is stopped"));
  sf_command command = {sizeof(sf_command)};
  double time = 0.0;
  const auto hold = [&](double end) {
    for (; time < end; time += 1e-3) {
      const sf_pose X_WFt = touching_pose(0.5);
      ASSERT_EQ(sf_rendering_step(scene, &X_WFt, time, &command), SF_DONE);
    }
  };
  hold(2.0);
  EXPECT_EQ(command.state, SF_RENDERING);
  EXPECT_EQ(sf_rendering_stop(scene), SF_DONE);
  hold(3.0);
  EXPECT_EQ(command.state, SF_RETRACTING);
  EXPECT_EQ(command.stopped, 1);
  EXPECT_EQ(command.stop_confirmed, 1);
  EXPECT_EQ(command.stops, 1u);
  EXPECT_EQ(sf_rendering_release(scene), SF_DONE);
  hold(5.0);
  EXPECT_EQ(command.stopped, 0);
  EXPECT_EQ(command.state, SF_RENDERING);
}

}  // namespace
}  // namespace softfinger
