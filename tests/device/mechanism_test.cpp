#include "softfinger/device/mechanism/mechanism.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "../support/derivative_check.hpp"
#include "../support/name_of_file.hpp"
#include "mechanisms.hpp"
#include "thimble.hpp"

namespace softfinger {
namespace {

const Device& thimble_by_bodies() {
  static const std::shared_ptr<const Device> device = mechanism("thimble-3rrs-mechanism");
  return *device;
}

/// Skin samples around a surface, the first 20 in contact.
struct Samples {
  explicit Samples(std::mt19937& random, const Vector3& centre_F) {
    std::uniform_real_distribution<double> off(-10.0, 10.0);
    std::uniform_real_distribution<double> some(0.5, 2.0);
    for (std::size_t i = 0; i < kCount; ++i) {
      x[i] = centre_F.x() + off(random) * mm;
      y[i] = centre_F.y() + off(random) * mm;
      z[i] = centre_F.z() + 0.3 * off(random) * mm;
      weight[i] = some(random);
      margin[i] = 0.2 * mm * some(random);
    }
  }
  [[nodiscard]] SurfaceSamples view() const { return {x, y, z, weight, margin, 20}; }

  static constexpr std::size_t kCount = 60;
  std::vector<double> x = std::vector<double>(kCount), y = x, z = x, weight = x, margin = x;
};

TEST(Mechanism, KinematicsAgreeWithTheClosedForm) {
  std::mt19937 random(1);
  double worst_joint = 0.0;
  double worst_pose = 0.0;
  double worst_back = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const Configuration q = random_reachable(random);
    JointAngles joints;
    JointAngles general;
    ASSERT_TRUE(thimble().inverse_kinematics(q, joints));
    ASSERT_TRUE(thimble_by_bodies().inverse_kinematics(q, general)) << q.transpose();
    ASSERT_TRUE(thimble_by_bodies().reachable(q)) << q.transpose();
    worst_joint = std::max(worst_joint, (joints - general).cwiseAbs().maxCoeff());
    const Pose X_FP = thimble().surface_pose(q);
    const Pose other = thimble_by_bodies().surface_pose(q);
    worst_pose = std::max({worst_pose, (X_FP.rotation - other.rotation).norm(),
                           (X_FP.translation - other.translation).norm()});
    Configuration back;
    ASSERT_TRUE(thimble_by_bodies().forward_kinematics(joints, back)) << q.transpose();
    worst_back = std::max(worst_back, (back - q).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst_joint, 1e-9);
  EXPECT_LT(worst_pose, 1e-9);
  EXPECT_LT(worst_back, 1e-9);
}

TEST(Mechanism, WorkspaceAgreesWithTheClosedForm) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> tilt(-40.0, 40.0);
  std::uniform_real_distribution<double> travel(-20.0, 20.0);
  int inside = 0;
  for (int i = 0; i < 3000; ++i) {
    const Configuration q = configuration(tilt(random), tilt(random), travel(random));
    EXPECT_EQ(thimble_by_bodies().reachable(q), thimble().reachable(q)) << q.transpose();
    inside += thimble().reachable(q) ? 1 : 0;
  }
  EXPECT_GT(inside, 300);
  EXPECT_LT(inside, 2700);
}

TEST(Mechanism, DeviationAgreesWithTheClosedForm) {
  std::mt19937 random(3);
  for (int i = 0; i < 1000; ++i) {
    const Configuration q = random_reachable(random);
    const Samples samples(random, thimble().surface_pose(q).translation);
    Eigen::VectorXd gradient(3);
    Eigen::VectorXd other_gradient(3);
    Eigen::MatrixXd gauss(3, 3);
    Eigen::MatrixXd other_gauss(3, 3);
    Eigen::MatrixXd hessian(3, 3);
    Eigen::MatrixXd other_hessian(3, 3);
    const SurfaceSamples view = samples.view();
    const double value = thimble().deviation_derivatives(q, view, gradient, gauss, hessian);
    const double other = thimble_by_bodies().deviation_derivatives(q, view, other_gradient,
                                                                   other_gauss, other_hessian);
    EXPECT_NEAR(other, value, 1e-9 * value);
    EXPECT_NEAR(thimble_by_bodies().deviation(q, view), value, 1e-9 * value);
    EXPECT_LT((other_gradient - gradient).norm(), 1e-9 * gradient.norm());
    EXPECT_LT((other_gauss - gauss).norm(), 1e-9 * gauss.norm());
    EXPECT_LT((other_hessian - hessian).norm(), 1e-8 * hessian.norm());
    EXPECT_NEAR(thimble_by_bodies().least_distance(q, view), thimble().least_distance(q, view),
                1e-12);
  }
}

TEST(Mechanism, FacesAndDrawsAsTheClosedForm) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  std::array<Vector3, 9> points;
  std::array<Vector3, 9> other;
  for (int i = 0; i < 200; ++i) {
    const Configuration q = random_reachable(random);
    const Vector3 normal = Vector3(part(random), part(random), part(random)).normalized();
    EXPECT_LT((thimble_by_bodies().facing(normal, q) - thimble().facing(normal, q)).norm(), 1e-12);
    ASSERT_EQ(thimble_by_bodies().leg_count(), 3);
    thimble().linkage(q, points);
    thimble_by_bodies().linkage(q, other);
    for (std::size_t k = 0; k < 9; ++k) EXPECT_LT((points[k] - other[k]).norm(), 1e-9);
  }
  EXPECT_EQ(thimble_by_bodies().approach_axis(), 2);
  EXPECT_EQ(thimble_by_bodies().disk_radius(), thimble().disk_radius());
}

// Every link is drawn, from the base to what touches, and only once.
TEST(Mechanism, DrawsBothArmsOfAFiveBar) {
  const auto device = mechanism("five-bar");
  ASSERT_EQ(device->leg_count(), 2);
  const Pose& X_FB = device->settings().X_FB;
  for (const double x : {-3.0 * mm, 0.0, 2.0 * mm}) {
    Configuration q = device->home();
    q[0] = x;
    ASSERT_TRUE(device->reachable(q));
    std::array<Vector3, 6> points;
    device->linkage(q, points);
    SolidPiece tip;
    device->solid_pieces(q, {&tip, 1});
    double side = 0.0;
    for (std::size_t leg = 0; leg < 2; ++leg) {
      const Vector3 servo = X_FB.inverse() * points[3 * leg];
      EXPECT_NEAR(std::abs(servo.x()), 6.0 * mm, 1e-12);
      EXPECT_NEAR(servo.z(), 31.0 * mm, 1e-12);
      side += servo.x();
      EXPECT_NEAR((points[3 * leg + 1] - points[3 * leg]).norm(), 12.0 * mm, 1e-9);
      EXPECT_NEAR((points[3 * leg + 2] - points[3 * leg + 1]).norm(), 24.0 * mm, 1e-9);
      EXPECT_LT((points[3 * leg + 2] - tip.X_FS.translation).norm(), 1e-9);
    }
    EXPECT_NEAR(side, 0.0, 1e-12) << "one on either side";
  }
}

// Two threads and another order of questions: the answer depends on q alone.
TEST(Mechanism, AnswersDependOnTheConfigurationAlone) {
  std::mt19937 random(5);
  std::vector<Configuration> asked;
  for (int i = 0; i < 200; ++i) asked.push_back(random_reachable(random));
  std::vector<JointAngles> forwards(asked.size());
  std::vector<JointAngles> backwards(asked.size());
  std::thread other([&] {
    for (std::size_t i = asked.size(); i-- > 0;) {
      static_cast<void>(thimble_by_bodies().inverse_kinematics(asked[i], backwards[i]));
    }
  });
  for (std::size_t i = 0; i < asked.size(); ++i) {
    static_cast<void>(thimble_by_bodies().inverse_kinematics(asked[i], forwards[i]));
  }
  other.join();
  for (std::size_t i = 0; i < asked.size(); ++i) EXPECT_EQ(forwards[i], backwards[i]);
}

/// The shipped mechanisms, each by itself.
class ShippedMechanism : public testing::TestWithParam<const char*> {
 protected:
  std::shared_ptr<const Device> device_ = mechanism(GetParam());
  ReachableConfigurations draws_{*device_, 25.0, 5.0, 6};
};

TEST_P(ShippedMechanism, ClosesEveryLoop) {
  const Linkage& linkage = linkage_of(*device_).description().linkage.linkage();
  for (int i = 0; i < 500; ++i) {
    const Configuration q = draws_.draw();
    LinkageSolution solution;
    ASSERT_TRUE(linkage_of(*device_).solve(q, solution));
    double worst = 0.0;
    for (int e = 0; e < linkage.equation_count(); ++e) {
      worst = std::max(worst, std::abs(linkage.residual(e, solution.placement)));
    }
    EXPECT_LT(worst, 1e-13);
    LinkageInputs read(device_->degrees_of_freedom());
    linkage.read(linkage_of(*device_).description().configuration, solution.x, solution.placement,
                 read);
    EXPECT_LT((read - q).norm(), 1e-12);
  }
}

TEST_P(ShippedMechanism, ForwardUndoesInverse) {
  for (int i = 0; i < 300; ++i) {
    const Configuration q = draws_.draw();
    JointAngles joints;
    Configuration back;
    ASSERT_TRUE(device_->inverse_kinematics(q, joints));
    ASSERT_TRUE(device_->forward_kinematics(joints, back)) << q.transpose();
    EXPECT_LT((back - q).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST_P(ShippedMechanism, ConstraintsAndTheirCurvatureAreDerivatives) {
  const int count = device_->constraint_count();
  const int n = device_->degrees_of_freedom();
  Eigen::VectorXd values(count);
  Eigen::MatrixXd jacobian(count, n);
  // The two on determinants have derivatives near a singularity only, and no curvature.
  std::vector<int> smooth;
  for (int k = 0; k < count; ++k) {
    if (k < 2 * device_->joint_count() || k > 2 * device_->joint_count() + 1) smooth.push_back(k);
  }
  const double length = linkage_of(*device_).description().linkage.linkage().length();
  int compared = 0;
  for (int i = 0; i < 50; ++i) {
    const Configuration q = draws_.draw();
    ASSERT_TRUE(device_->constraints(q, values, jacobian));
    EXPECT_LE(values.maxCoeff(), 1e-9);
    // Where a leg is almost stretched, rates vary too fast for differences.
    if (values[2 * device_->joint_count()] > -0.2 * length) continue;
    ++compared;
    const auto values_at = [&](const Eigen::VectorXd& at) {
      Eigen::VectorXd v(count);
      Eigen::MatrixXd j(count, n);
      EXPECT_TRUE(device_->constraints(at, v, j));
      return Eigen::VectorXd(v(smooth));
    };
    EXPECT_LT(derivative_error(values_at, q, jacobian(smooth, Eigen::all), steps_of(*device_)),
              1e-6);
    Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(count);
    for (const int k : smooth) multipliers[k] = 0.5 + 0.1 * k;
    Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(n, n);
    device_->add_constraint_curvature(q, multipliers, curvature);
    const auto gradient_at = [&](const Eigen::VectorXd& at) {
      Eigen::VectorXd v(count);
      Eigen::MatrixXd j(count, n);
      EXPECT_TRUE(device_->constraints(at, v, j));
      return Eigen::VectorXd(j.transpose() * multipliers);
    };
    // Of a long arm's little curvature differences know less.
    const double most = std::string(GetParam()).starts_with("slip-") ? 1e-5 : 1e-6;
    EXPECT_LT(derivative_error(gradient_at, q, curvature, steps_of(*device_)), most);
  }
  EXPECT_GT(compared, 10);
}

TEST_P(ShippedMechanism, DeviationDerivativesAreDerivatives) {
  const int n = device_->degrees_of_freedom();
  Eigen::VectorXd gradient(n);
  Eigen::MatrixXd gauss(n, n);
  Eigen::MatrixXd hessian(n, n);
  int smooth = 0;
  for (int i = 0; i < 40; ++i) {
    const Configuration q = draws_.draw();
    const Samples samples(draws_.random(), device_->surface_pose(q).translation);
    const SurfaceSamples view = samples.view();
    const double value = device_->deviation_derivatives(q, view, gradient, gauss, hessian);
    Eigen::VectorXd plain_gradient(n);
    Eigen::MatrixXd plain_gauss(n, n);
    Eigen::MatrixXd unused(n, n);
    const double plain =
        device_->Device::deviation_derivatives(q, view, plain_gradient, plain_gauss, unused);
    EXPECT_NEAR(value, plain, 1e-12 * plain);
    EXPECT_LT((gradient - plain_gradient).norm(), 1e-10 * plain_gradient.norm());
    EXPECT_LT((gauss - plain_gauss).norm(), 1e-10 * plain_gauss.norm());
    const auto value_at = [&](const Eigen::VectorXd& at) {
      return Eigen::VectorXd::Constant(1, device_->deviation(at, view)).eval();
    };
    EXPECT_LT(derivative_error(value_at, q, gradient.transpose(), steps_of(*device_)), 1e-5);
    const auto gradient_at = [&](const Eigen::VectorXd& at) {
      Eigen::VectorXd g(n);
      Eigen::MatrixXd a(n, n);
      Eigen::MatrixXd b(n, n);
      device_->deviation_derivatives(at, view, g, a, b);
      return g;
    };
    // A sample near a kink spoils a difference of gradients; most trials have none.
    const double error = derivative_error(gradient_at, q, hessian, steps_of(*device_));
    smooth += error < 1e-5 ? 1 : 0;
    EXPECT_LT(error, 1.0);
    EXPECT_LT((hessian - hessian.transpose()).norm(), 1e-9 * hessian.norm());
  }
  EXPECT_GE(smooth, 25);
}

// The two determinants near where they vanish, against differences.
TEST(Mechanism, SingularityConstraintsAreDerivativesNearby) {
  const Device& device = thimble_by_bodies();
  const double length = linkage_of(device).description().linkage.linkage().length();
  std::mt19937 random(8);
  std::uniform_real_distribution<double> tilt(-35.0, 35.0);
  std::uniform_real_distribution<double> travel(-15.0, 15.0);
  const int count = device.constraint_count();
  Eigen::VectorXd values(count);
  Eigen::MatrixXd jacobian(count, 3);
  std::array<int, 2> compared{};
  for (int i = 0; i < 8000; ++i) {
    const Configuration q = configuration(tilt(random), tilt(random), travel(random));
    if (!device.constraints(q, values, jacobian)) continue;
    for (int which = 0; which < 2; ++which) {
      const int row = 2 * device.joint_count() + which;
      const double vanishing = -values[row] / length;  // square of the ratio, and the ratio
      const double least = which == 0 ? 0.001 : 0.01;
      if (vanishing < least || vanishing > (which == 0 ? 0.009 : 0.095)) continue;
      const auto value_at = [&](const Eigen::VectorXd& at) {
        Eigen::VectorXd v(count);
        Eigen::MatrixXd j(count, 3);
        EXPECT_TRUE(device.constraints(at, v, j));
        return Eigen::VectorXd::Constant(1, v[row]).eval();
      };
      EXPECT_LT(derivative_error(value_at, q, jacobian.row(row), Eigen::Vector3d(1e-6, 1e-6, 1e-8)),
                1e-5);
      ++compared[static_cast<std::size_t>(which)];
    }
  }
  EXPECT_GT(compared[0], 10);
  EXPECT_GT(compared[1], 5);
}

// Far out, where nothing closes, all answers are still numbers.
TEST_P(ShippedMechanism, GoesOnStraightWhereItDoesNotClose) {
  for (const double factor : {1.0, -1.0, 1e6}) {
    Configuration q = device_->home();
    for (int k = 0; k < q.size(); ++k) {
      q[k] += factor * 100.0 * device_->axes()[static_cast<std::size_t>(k)].unit();
    }
    JointAngles joints;
    EXPECT_FALSE(device_->inverse_kinematics(q, joints));
    EXPECT_FALSE(device_->reachable(q));
    device_->clamped_joints(q, joints);
    EXPECT_TRUE(joints.allFinite());
    EXPECT_TRUE(device_->surface_pose(q).translation.allFinite());
    EXPECT_TRUE(std::isfinite(device_->signed_distance(q, Vector3::Zero()).distance));
  }
  Configuration q = device_->home();
  q[0] = std::nan("");
  EXPECT_FALSE(device_->reachable(q));
  EXPECT_TRUE(device_->surface_pose(q).translation.allFinite());
}

INSTANTIATE_TEST_SUITE_P(Devices, ShippedMechanism,
                         testing::Values("thimble-3rrs-mechanism", "five-bar", "plate-6dof",
                                         "slip-ball-webster", "slip-wheel-salada"),
                         name_of_file<const char*>);

}  // namespace
}  // namespace softfinger
