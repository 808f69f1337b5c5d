// Poses of game engines against their definition: p_U = M p_W and R_U = M R_W M^-1.
#include <gtest/gtest.h>

#include <random>

#include "poses.hpp"

namespace softfinger {
namespace {

sf_pose random_pose(std::mt19937& random) {
  std::normal_distribution<double> any(0.0, 1.0);
  const Eigen::Quaterniond q =
      Eigen::Quaterniond(any(random), any(random), any(random), any(random)).normalized();
  return {sizeof(sf_pose), {any(random), any(random), any(random)}, {q.w(), q.x(), q.y(), q.z()}};
}

Matrix3 rotation_of(const double (&xyzw)[4]) {
  return Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).toRotationMatrix();
}

void expect_same(const sf_pose& a, const sf_pose& b) {
  EXPECT_LT((as_cpp(a).translation - as_cpp(b).translation).norm(), 1e-15);
  EXPECT_LT((as_cpp(a).rotation - as_cpp(b).rotation).norm(), 1e-15);
}

TEST(EngineFrames, UnityIsLeftHandedWithYUp) {
  Matrix3 M;
  M << 0, -1, 0, 0, 0, 1, 1, 0, 0;
  ASSERT_EQ(M.determinant(), -1.0);
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const sf_pose pose = random_pose(random);
    sf_unity_pose unity = {sizeof(sf_unity_pose), {}, {}};
    ASSERT_EQ(sf_pose_to_unity(&pose, &unity), SF_DONE);
    const Pose X = as_cpp(pose);
    EXPECT_LT((Vector3(unity.position_m) - M * X.translation).norm(), 1e-15);
    EXPECT_LT((rotation_of(unity.quaternion_xyzw) - M * X.rotation * M.transpose()).norm(), 1e-14);
    sf_pose back = {sizeof(sf_pose), {}, {}};
    ASSERT_EQ(sf_pose_from_unity(&unity, &back), SF_DONE);
    expect_same(back, pose);
  }
}

TEST(EngineFrames, UnrealIsLeftHandedWithZUpInCentimetres) {
  const Matrix3 M = Vector3(1.0, -1.0, 1.0).asDiagonal();
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const sf_pose pose = random_pose(random);
    sf_unreal_pose unreal = {sizeof(sf_unreal_pose), {}, {}};
    ASSERT_EQ(sf_pose_to_unreal(&pose, &unreal), SF_DONE);
    const Pose X = as_cpp(pose);
    EXPECT_LT((Vector3(unreal.position_cm) - 100.0 * M * X.translation).norm(), 1e-13);
    EXPECT_LT((rotation_of(unreal.quaternion_xyzw) - M * X.rotation * M).norm(), 1e-14);
    sf_pose back = {sizeof(sf_pose), {}, {}};
    ASSERT_EQ(sf_pose_from_unreal(&unreal, &back), SF_DONE);
    expect_same(back, pose);
  }
}

// 10 cm ahead, 20 cm to the left, 30 cm up, the fingertip turned 90 degrees to the left.
TEST(EngineFrames, AsOneThinksOfThem) {
  const double half = std::sqrt(0.5);
  const sf_pose pose = {sizeof(sf_pose), {0.1, 0.2, 0.3}, {half, 0.0, 0.0, half}};
  sf_unity_pose unity = {sizeof(sf_unity_pose), {}, {}};
  sf_unreal_pose unreal = {sizeof(sf_unreal_pose), {}, {}};
  ASSERT_EQ(sf_pose_to_unity(&pose, &unity), SF_DONE);
  ASSERT_EQ(sf_pose_to_unreal(&pose, &unreal), SF_DONE);
  // Unity: x right, y up, z ahead. A turn to the left is one of -90 degrees about y.
  EXPECT_EQ(Vector3(unity.position_m), Vector3(-0.2, 0.3, 0.1));
  EXPECT_EQ(unity.quaternion_xyzw[1], -half);
  EXPECT_LT((rotation_of(unity.quaternion_xyzw) * Vector3(0, 0, 1) - Vector3(-1, 0, 0)).norm(),
            1e-15);
  // Unreal: x ahead, y right, z up.
  EXPECT_LT((Vector3(unreal.position_cm) - Vector3(10.0, -20.0, 30.0)).norm(), 1e-14);
  EXPECT_LT((rotation_of(unreal.quaternion_xyzw) * Vector3(1, 0, 0) - Vector3(0, -1, 0)).norm(),
            1e-15);
}

TEST(EngineFrames, WrongSizesAreRefused) {
  sf_pose pose = touching_pose(0.0);
  sf_unity_pose unity = {4, {}, {}};
  sf_unreal_pose unreal = {sizeof(sf_unreal_pose), {}, {}};
  EXPECT_EQ(sf_pose_to_unity(&pose, &unity), SF_BAD_INPUT);
  EXPECT_EQ(sf_pose_to_unity(nullptr, &unity), SF_BAD_INPUT);
  EXPECT_EQ(sf_pose_from_unity(&unity, &pose), SF_BAD_INPUT);
  EXPECT_EQ(sf_pose_from_unreal(&unreal, nullptr), SF_BAD_INPUT);
  pose.size = 0;
  EXPECT_EQ(sf_pose_to_unreal(&pose, &unreal), SF_BAD_INPUT);
}

}  // namespace
}  // namespace softfinger
