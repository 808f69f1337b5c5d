#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "../support/derivative_check.hpp"
#include "thimble.hpp"

namespace softfinger {
namespace {

TEST(Kinematics, ForwardUndoesInverseOverTheWorkspace) {
  std::mt19937 random(1);
  double worst_angle = 0.0;
  double worst_travel = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const Configuration q = random_reachable(random);
    JointAngles joints;
    ASSERT_TRUE(thimble().inverse_kinematics(q, joints));
    Configuration back;
    ASSERT_TRUE(thimble().forward_kinematics(joints, back)) << q.transpose();
    worst_angle = std::max(worst_angle, (back - q).head(2).cwiseAbs().maxCoeff());
    worst_travel = std::max(worst_travel, std::abs(back[2] - q[2]));
  }
  EXPECT_LT(worst_angle, 1e-8);
  EXPECT_LT(worst_travel, 1e-10);
}

// The linkage drawn from the joint angles closes: all lengths and planes are as built.
TEST(Kinematics, LinksKeepTheirLengthsAndPlanes) {
  std::mt19937 random(2);
  const Platform3rrsGeometry& geometry = thimble_legs().geometry();
  const Pose X_BF = thimble().settings().X_FB.inverse();
  for (int i = 0; i < 1000; ++i) {
    const Configuration q = random_reachable(random);
    std::array<Vector3, 9> points;
    thimble().linkage(q, points);
    const Pose X_FP = thimble().surface_pose(q);
    for (std::size_t leg = 0; leg < 3; ++leg) {
      const Vector3 base = X_BF * points[3 * leg];
      const Vector3 knee = X_BF * points[3 * leg + 1];
      const Vector3 joint = X_BF * points[3 * leg + 2];
      EXPECT_NEAR((knee - base).norm(), geometry.crank, 1e-12);
      EXPECT_NEAR((joint - knee).norm(), geometry.coupler, 1e-12);
      EXPECT_NEAR((joint - X_BF * X_FP.translation).norm(), geometry.platform_radius, 1e-12);
      const double azimuth = 120.0 * deg * static_cast<double>(leg);
      const Vector3 tangent(-std::sin(azimuth), std::cos(azimuth), 0.0);
      EXPECT_NEAR(tangent.dot(joint), 0.0, 1e-14);
      EXPECT_NEAR(tangent.dot(knee), 0.0, 1e-14);
      EXPECT_NEAR(base.z(), geometry.neutral_height, 1e-15);
    }
  }
}

TEST(Kinematics, OrientationIsTheRotationVector) {
  const Configuration q = configuration(12.0, -7.0, 1.5);
  const Pose X_BP = thimble().settings().X_FB.inverse() * thimble().surface_pose(q);
  EXPECT_LT((X_BP.rotation - exp_rotation({q[1], q[0], 0.0})).norm(), 1e-14);
  const double rp = thimble_legs().geometry().platform_radius;
  const Matrix3& m = X_BP.rotation;
  EXPECT_NEAR(X_BP.translation.x(), 0.5 * rp * (m(0, 0) - m(1, 1)), 1e-15);
  EXPECT_NEAR(X_BP.translation.y(), -rp * m(0, 1), 1e-15);
  EXPECT_NEAR(X_BP.translation.z(), q[2], 1e-15);
  EXPECT_GT(m(0, 2), 0.0);  // pitch > 0 tips the normal distally
  EXPECT_GT(m(1, 2), 0.0);  // roll < 0 tips it to +y
}

TEST(Kinematics, JointJacobianIsTheDerivative) {
  std::mt19937 random(3);
  double worst = 0.0;
  for (int i = 0; i < 500; ++i) {
    const Configuration q = random_reachable(random);
    Matrix3 jacobian;
    ASSERT_TRUE(thimble_legs().joint_jacobian(q, jacobian));
    const auto joints_at = [&](const Eigen::VectorXd& at) {
      JointAngles joints;
      EXPECT_TRUE(thimble().inverse_kinematics(at, joints));
      return Eigen::VectorXd(joints);
    };
    worst = std::max(worst, derivative_error(joints_at, q, jacobian, difference_steps()));
  }
  EXPECT_LT(worst, 1e-7);
}

TEST(Kinematics, ConstraintsAndTheirCurvatureAreDerivatives) {
  std::mt19937 random(4);
  const int count = thimble().constraint_count();
  Eigen::VectorXd values(count);
  Eigen::MatrixXd jacobian(count, 3);
  double worst = 0.0;
  double worst_curvature = 0.0;
  for (int i = 0; i < 300; ++i) {
    const Configuration q = random_reachable(random);
    ASSERT_TRUE(thimble().constraints(q, values, jacobian));
    EXPECT_LE(values.maxCoeff(), 1e-9);
    const auto values_at = [&](const Eigen::VectorXd& at) {
      Eigen::VectorXd v(count);
      Eigen::MatrixXd j(count, 3);
      EXPECT_TRUE(thimble().constraints(at, v, j));
      return Eigen::VectorXd(v.head(count - 1));
    };
    worst = std::max(
        worst, derivative_error(values_at, q, jacobian.topRows(count - 1), difference_steps()));
    Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(count);
    multipliers[i % (count - 1)] = 1.7;
    Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(3, 3);
    thimble().add_constraint_curvature(q, multipliers, curvature);
    const auto gradient_at = [&](const Eigen::VectorXd& at) {
      Eigen::VectorXd v(count);
      Eigen::MatrixXd j(count, 3);
      EXPECT_TRUE(thimble().constraints(at, v, j));
      return Eigen::VectorXd(j.transpose() * multipliers);
    };
    worst_curvature =
        std::max(worst_curvature, derivative_error(gradient_at, q, curvature, difference_steps()));
  }
  EXPECT_LT(worst, 1e-6);
  EXPECT_LT(worst_curvature, 1e-5);
}

TEST(Kinematics, ForwardRefusesWhatHasNoPoseInTheWorkspace) {
  JointAngles joints(3);
  Configuration q;
  joints << 70.0 * deg, -30.0 * deg, -30.0 * deg;  // far more tilt than allowed
  EXPECT_FALSE(thimble().forward_kinematics(joints, q));
  joints << 0.0, std::nan(""), 0.0;
  EXPECT_FALSE(thimble().forward_kinematics(joints, q));
}

TEST(Kinematics, FacingTurnsTheDiskAlongTheNormal) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> tilt(-20.0, 20.0);
  for (int i = 0; i < 100; ++i) {
    const Configuration q = configuration(tilt(random), tilt(random), 1.0);
    const Vector3 normal_F = thimble().surface_pose(q).rotation.col(2);
    EXPECT_LT((thimble().facing(normal_F, configuration(0.0, 0.0, 1.0)) - q).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace softfinger
