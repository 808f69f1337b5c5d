#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "../support/derivative_check.hpp"
#include "../support/folders.hpp"
#include "kinds.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/device/kinds/cable_platform.hpp"
#include "softfinger/device/kinds/delta_tactor.hpp"
#include "softfinger/device/kinds/pin_array.hpp"
#include "softfinger/geometry/msh_file.hpp"

namespace softfinger {
namespace {

std::string file_stem(const testing::TestParamInfo<std::filesystem::path>& info) {
  std::string name = info.param.stem().string();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

/// What holds for every device that is shipped.
class EveryDevice : public testing::TestWithParam<std::filesystem::path> {
 protected:
  std::shared_ptr<const Device> device_ = load_device(GetParam());
  std::mt19937 random_{7};
};

TEST_P(EveryDevice, ForwardUndoesInverseAndJointsKeepTheirLimits) {
  for (int i = 0; i < 300; ++i) {
    const Configuration q = random_reachable(*device_, random_);
    JointAngles joints;
    ASSERT_TRUE(device_->inverse_kinematics(q, joints));
    ASSERT_EQ(joints.size(), device_->joint_count());
    EXPECT_LE((joints - device_->joint_limits().max).maxCoeff(), 1e-9);
    EXPECT_LE((device_->joint_limits().min - joints).maxCoeff(), 1e-9);
    JointAngles cut;
    device_->clamped_joints(q, cut);
    EXPECT_LT((cut - joints).cwiseAbs().maxCoeff(), 1e-9);
    Configuration back;
    ASSERT_TRUE(device_->forward_kinematics(joints, back)) << q.transpose();
    EXPECT_LT(std::sqrt(device_->squared_distance(q, back)), 1e-9);
  }
}

TEST_P(EveryDevice, ConstraintsHoldInTheWorkspaceAndNotOutside) {
  Eigen::VectorXd values(device_->constraint_count());
  Eigen::MatrixXd jacobian(device_->constraint_count(), device_->degrees_of_freedom());
  int outside = 0;
  for (int i = 0; i < 2000; ++i) {
    Configuration q = random_configuration(*device_, random_);
    const Configuration far = random_configuration(*device_, random_);
    q += 0.6 * (far - device_->home());  // beyond the axes as well
    const bool defined = device_->constraints(q, values, jacobian);
    if (device_->reachable(q)) {
      EXPECT_TRUE(defined);
      EXPECT_LE(values.maxCoeff(), 1e-8);
    } else {
      ++outside;
      // A workspace may be cut in ways that lie on no constraint (a singularity between it and q).
      if (defined && device_->kind() != "platform_3rrs" && device_->kind() != "mechanism" &&
          device_->kind() != "delta_tactor") {
        EXPECT_GT(values.maxCoeff(), -1e-8) << q.transpose();
      }
    }
  }
  EXPECT_GT(outside, 100);
}

TEST_P(EveryDevice, ConstraintsAndTheirCurvatureAreDerivatives) {
  if (device_->kind() == "platform_3rrs" || device_->kind() == "mechanism") return;  // own tests
  const int count = device_->constraint_count();
  const int n = device_->degrees_of_freedom();
  // Tensions are taken as straight.
  const auto curved = [&](int k) { return device_->kind() != "cable_platform" || k < 6 || k == 9; };
  Eigen::VectorXd values(count);
  Eigen::MatrixXd jacobian(count, n);
  double worst = 0.0;
  double worst_curvature = 0.0;
  for (int i = 0; i < (n > 10 ? 10 : 200); ++i) {
    const Configuration q = random_reachable(*device_, random_);
    ASSERT_TRUE(device_->constraints(q, values, jacobian));
    const auto values_at = [&](const Eigen::VectorXd& at) {
      Eigen::VectorXd v(count);
      Eigen::MatrixXd j(count, n);
      EXPECT_TRUE(device_->constraints(at, v, j));
      return v;
    };
    worst = std::max(worst, derivative_error(values_at, q, jacobian, difference_steps(*device_)));
    Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(count);
    if (!curved(i % count)) continue;
    multipliers[i % count] = 1.7;
    Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(n, n);
    device_->add_constraint_curvature(q, multipliers, curvature);
    const auto gradient_at = [&](const Eigen::VectorXd& at) {
      Eigen::VectorXd v(count);
      Eigen::MatrixXd j(count, n);
      EXPECT_TRUE(device_->constraints(at, v, j));
      return Eigen::VectorXd(j.transpose() * multipliers);
    };
    worst_curvature = std::max(
        worst_curvature,
        derivative_error(gradient_at, q, curvature, 100.0 * difference_steps(*device_), 1.0));
  }
  EXPECT_LT(worst, 1e-5);
  EXPECT_LT(worst_curvature, 1e-4);
}

TEST_P(EveryDevice, DistancesHaveTheirDerivatives) {
  double worst_closest = 0.0;
  double worst_signed = 0.0;
  int kinks = 0;
  constexpr int kPoints = 400;
  for (int i = 0; i < kPoints; ++i) {
    const Configuration q = random_reachable(*device_, random_);
    const Vector3 p_F = random_pad_point(random_);
    const auto residual_at = [&](const Eigen::VectorXd& at) {
      return Eigen::VectorXd(device_->closest_point_residual(at, p_F).residual);
    };
    const auto distance_at = [&](const Eigen::VectorXd& at) {
      return Eigen::VectorXd::Constant(1, device_->signed_distance(at, p_F).distance).eval();
    };
    const Eigen::VectorXd steps = difference_steps(*device_);
    const double closest = derivative_error(
        residual_at, q, device_->closest_point_residual(q, p_F).jacobian, steps, 1e-2);
    const double distance = derivative_error(
        distance_at, q, device_->signed_distance(q, p_F).gradient.transpose(), steps, 1e-2);
    // Differences across a kink say nothing; few points lie that near one.
    if (closest > 1e-3 || distance > 1e-3) {
      ++kinks;
      continue;
    }
    worst_closest = std::max(worst_closest, closest);
    worst_signed = std::max(worst_signed, distance);
  }
  EXPECT_LE(kinks, kPoints / 100);
  EXPECT_LT(worst_closest, 1e-5);
  EXPECT_LT(worst_signed, 1e-5);
}

// A finger that is moved along with it feels the same; but for rounding.
TEST_P(EveryDevice, IsTheSameMountedElsewhere) {
  const auto shifted = load_device(GetParam(), 0.7 * mm);
  const Pose fit{exp_rotation({3.0 * deg, -5.0 * deg, 0.0}), {1.0 * mm, -0.5 * mm, 0.3 * mm}};
  // A fit does not add to one before.
  const auto moved = shifted->mounted({Matrix3::Identity(), {0.0, 0.0, 2.0 * mm}})->mounted(fit);
  const Pose& X_FB = shifted->settings().X_FB;
  const Pose& X_FB_moved = moved->settings().X_FB;
  EXPECT_LT((X_FB_moved.translation - X_FB.translation - fit.translation).norm(), 1e-12);
  EXPECT_LT((X_FB_moved.rotation - fit.rotation * X_FB.rotation).norm(), 1e-12);
  const Pose move = X_FB_moved * X_FB.inverse();
  std::vector<SolidPiece> before(static_cast<std::size_t>(moved->solid_piece_count()));
  std::vector<SolidPiece> after = before;
  std::vector<Vector3> legs(static_cast<std::size_t>(3 * moved->leg_count()));
  std::vector<Vector3> legs_moved = legs;
  for (int i = 0; i < 40; ++i) {
    const Configuration q = random_reachable(*shifted, random_);
    const Vector3 p_F = random_pad_point(random_);
    EXPECT_NEAR(moved->signed_distance(q, move * p_F).distance,
                shifted->signed_distance(q, p_F).distance, 1e-12);
    const Pose surface = move * shifted->surface_pose(q);
    EXPECT_LT((moved->surface_pose(q).translation - surface.translation).norm(), 1e-12);
    EXPECT_LT((moved->surface_pose(q).rotation - surface.rotation).norm(), 1e-12);
    shifted->solid_pieces(q, before);
    moved->solid_pieces(q, after);
    for (std::size_t k = 0; k < before.size(); ++k) {
      const Pose piece = move * before[k].X_FS;
      EXPECT_LT((after[k].X_FS.translation - piece.translation).norm(), 1e-12);
      EXPECT_LT((after[k].X_FS.rotation - piece.rotation).norm(), 1e-12);
    }
    shifted->linkage(q, legs);
    moved->linkage(q, legs_moved);
    for (std::size_t k = 0; k < legs.size(); ++k) {
      EXPECT_LT((legs_moved[k] - move * legs[k]).norm(), 1e-12);
    }
    JointAngles joints, joints_moved;
    ASSERT_TRUE(shifted->inverse_kinematics(q, joints));
    ASSERT_TRUE(moved->inverse_kinematics(q, joints_moved));
    EXPECT_EQ(joints, joints_moved);
    EXPECT_TRUE(moved->reachable(q));
  }
}

TEST_P(EveryDevice, SumsOverSamplesAgreeWithSingleQueries) {
  constexpr int kCount = 60;
  std::vector<double> x(kCount), y(kCount), z(kCount), w(kCount, 1.3), margin(kCount, 0.2 * mm);
  for (int trial = 0; trial < 20; ++trial) {
    const Configuration q = random_reachable(*device_, random_);
    double least = 1.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < kCount; ++i) {
      const Vector3 p = random_pad_point(random_);
      x[i] = p.x();
      y[i] = p.y();
      z[i] = p.z();
      const double distance = device_->signed_distance(q, p).distance;
      least = std::min(least, distance);
      const double lack = std::min(0.0, distance - 0.2 * mm);
      sum += 1.3 *
             (i < 20 ? device_->closest_point_residual(q, p).residual.squaredNorm() : lack * lack);
    }
    const SurfaceSamples samples{x, y, z, w, margin, 20};
    EXPECT_NEAR(device_->least_distance(q, samples), least, 1e-14);
    EXPECT_NEAR(device_->deviation(q, samples), sum, 1e-12 * sum);
  }
}

// So nothing jumps when the following of the skin begins.
TEST_P(EveryDevice, HomeLeavesTheApproachDistanceToTheRestingSkin) {
  const TetrahedralMesh mesh = read_msh(source_folder() + "/fingers/index.msh", mm);
  std::vector<double> x, y, z;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.surface_names[static_cast<std::size_t>(mesh.triangle_surface[t])] != "skin") continue;
    for (const int node : mesh.triangles[t]) {
      const Vector3& p = mesh.nodes[static_cast<std::size_t>(node)];
      x.push_back(p.x());
      y.push_back(p.y());
      z.push_back(p.z());
    }
  }
  const SurfaceSamples skin{x, y, z, {}, {}, 0};
  EXPECT_NEAR(device_->least_distance(device_->home(), skin), device_->settings().matching.approach,
              0.5 * mm);
}

// The solid's thickness and rounded rims apart, it is the surface: nothing of it stands out.
TEST_P(EveryDevice, SolidLiesWithinTheSurface) {
  std::vector<SolidPiece> pieces(static_cast<std::size_t>(device_->solid_piece_count()));
  Configuration q;
  int inside = 0;
  // Pins fill little of the pad's space: many points are thrown at each configuration.
  for (int i = 0; i < 30 * 400; ++i) {
    if (i % 400 == 0) {
      q = random_reachable(*device_, random_);
      device_->solid_pieces(q, pieces);
    }
    const Vector3 p_F = random_pad_point(random_);
    double least = 1.0;
    for (const SolidPiece& piece : pieces) {
      least = std::min(least, signed_distance(piece.shape, piece.X_FS.inverse() * p_F).distance);
    }
    if (least > 0.0) continue;
    // A membrane's plate reaches out beyond the ring, and its ball below the plate.
    const Vector3 p_B = device_->settings().X_FB.inverse() * p_F;
    if (device_->kind() == "membrane" && std::hypot(p_B.x(), p_B.y()) > 7.0 * mm) continue;
    EXPECT_LT(device_->signed_distance(q, p_F).distance, 1e-9) << p_F.transpose();
    ++inside;
  }
  EXPECT_GT(inside, 20);
}

INSTANTIATE_TEST_SUITE_P(Devices, EveryDevice, testing::ValuesIn(device_files()), file_stem);

TEST(PinArray, DistancesAreThoseOfFlatEndedCylinders) {
  const auto device = shipped("pins-wagner-6x6");
  const Device& pins = *device;
  const PinArrayGeometry& geometry = dynamic_cast<const PinSurface&>(pins.surface()).geometry();
  const Pose X_BF = pins.settings().X_FB.inverse();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> across(-9.0, 9.0);
  std::uniform_real_distribution<double> up(-3.0, 4.0);
  for (int i = 0; i < 3000; ++i) {
    const Configuration q = random_reachable(pins, random);
    const Vector3 p_B = Vector3(across(random), across(random), up(random)) * mm;
    double to_end = 1.0;
    double to_pins = 1.0;
    for (int row = 0; row < geometry.rows; ++row) {
      for (int column = 0; column < geometry.columns; ++column) {
        const double height = q[row * geometry.columns + column];
        const Vector3 end((row - 2.5) * geometry.pitch, (column - 2.5) * geometry.pitch, height);
        constexpr double kLong = 0.1;
        to_pins =
            std::min(to_pins, signed_distance(RoundedCylinder{geometry.pin_radius, kLong, 0.0},
                                              p_B - end + kLong * Vector3::UnitZ())
                                  .distance);
        const double aside = std::hypot(p_B.x() - end.x(), p_B.y() - end.y());
        to_end = std::min(
            to_end, std::hypot(std::max(0.0, aside - geometry.pin_radius), p_B.z() - end.z()));
      }
    }
    const Vector3 p_F = X_BF.inverse() * p_B;
    EXPECT_NEAR(pins.signed_distance(q, p_F).distance, to_pins, 1e-12);
    EXPECT_NEAR(pins.closest_point_residual(q, p_F).residual.norm(), to_end, 1e-12);
  }
}

TEST(PinArray, NamesCountFromTheProximalSide) {
  const auto device = shipped("pins-sarakoglou-4x4");
  EXPECT_EQ(device->axes()[1].name, "height_0_1_mm");
  Configuration q = Configuration::Zero(16);
  q[1] = 1.0 * mm;
  std::vector<SolidPiece> pieces(16);
  device->solid_pieces(q, pieces);
  const Vector3 p_B = device->settings().X_FB.inverse() * pieces[1].X_FS.translation;
  EXPECT_NEAR(p_B.x(), -3.0 * mm, 1e-12);
  EXPECT_NEAR(p_B.y(), -1.0 * mm, 1e-12);
}

TEST(MembraneSurface, DistancesAgreeWithSearchOverTheCap) {
  const auto device = shipped("membrane");
  const double ring = device->cap_radius();
  std::mt19937 random(4);
  std::uniform_real_distribution<double> across(0.0, 10.0);
  std::uniform_real_distribution<double> up(-3.0, 6.0);
  for (int i = 0; i < 300; ++i) {
    Configuration q = random_reachable(*device, random);
    if (i % 10 == 0) q[0] = i % 20 == 0 ? 0.0 : 1e-9;
    const double rho = across(random) * mm;
    const double z = up(random) * mm;
    const double h = q[0];
    double to_cap = 1.0;
    double to_flank = 1.0;
    for (int k = 0; k <= 20000; ++k) {
      const double a = ring * k / 20000.0;
      // Height of the cap over the ring's plane, without the ball's centre, which may be far.
      const double k2 = 2.0 * h / (ring * ring + h * h);
      const double rise = h - k2 * a * a / (1.0 + std::sqrt(std::max(0.0, 1.0 - k2 * k2 * a * a)));
      to_cap = std::min(to_cap, std::hypot(rho - a, z - rise));
      const double s = 20.0 * mm * k / 20000.0;
      to_flank = std::min(to_flank, std::hypot(rho - ring - s, z + s));
    }
    const double k2 = 2.0 * h / (ring * ring + h * h);
    const bool under_cap =
        rho <= ring && z <= h - k2 * rho * rho / (1.0 + std::sqrt(1.0 - k2 * k2 * rho * rho));
    const bool inside = z >= 0.0 ? under_cap : rho <= ring - z;
    const Vector3 p_F = device->settings().X_FB * Vector3(rho * 0.6, rho * 0.8, z);
    EXPECT_NEAR(device->closest_point_residual(q, p_F).residual.norm(), to_cap, 2e-6);
    EXPECT_NEAR(device->signed_distance(q, p_F).distance,
                (inside ? -1.0 : 1.0) * std::min(to_cap, to_flank), 2e-6)
        << rho << " " << z << " " << h;
  }
}

TEST(DeltaTactor, LinksKeepTheirLengths) {
  const auto device = shipped("delta-schorr");
  const DeltaTactorGeometry& geometry =
      dynamic_cast<const DeltaTactor&>(device->kinematics()).geometry();
  std::mt19937 random(5);
  for (int i = 0; i < 1000; ++i) {
    const Configuration q = random_reachable(*device, random);
    std::array<Vector3, 9> points;
    device->linkage(q, points);
    for (std::size_t leg = 0; leg < 3; ++leg) {
      EXPECT_NEAR((points[3 * leg + 1] - points[3 * leg]).norm(), geometry.crank, 1e-12);
      EXPECT_NEAR((points[3 * leg + 2] - points[3 * leg + 1]).norm(), geometry.forearm, 1e-12);
    }
  }
}

// Sizes at random: wherever it solves, it finds the way back, with the tip above the knees or
// below.
TEST(DeltaTactor, ForwardUndoesInverseForAnySizes) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / ("delta_" + std::to_string(getpid()) + ".toml");
  std::mt19937 random(11);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int tried = 0;
  int below = 0;
  for (int i = 0; i < 300; ++i) {
    const double crank = i == 0 ? 30.0 : between(6.0, 40.0);
    const double forearm = i == 0 ? 20.0 : between(10.0, 40.0);
    std::ofstream(file) << "kind = \"delta_tactor\"\n[geometry]\nbase_radius_mm = 12.0\n"
                           "platform_radius_mm = 4.0\ncrank_mm = "
                        << crank << "\nforearm_mm = " << forearm
                        << "\nneutral_height_mm = " << (i == 0 ? 17.0 : between(8.0, 40.0))
                        << "\ntip_radius_mm = 3.0\n[limits]\njoint_deg = [-40.0, 100.0]\n"
                           "joint_rate_deg_per_s = 400.0\n";
    std::shared_ptr<const Device> device;
    try {
      device = load_device(file);
    } catch (const InputError&) {
      ASSERT_NE(i, 0);
      continue;
    }
    const DeltaTactorGeometry& geometry =
        dynamic_cast<const DeltaTactor&>(device->kinematics()).geometry();
    for (int k = 0; k < 40; ++k) {
      const Configuration q = k == 0 ? device->home() : random_reachable(*device, random);
      JointAngles joints;
      Configuration back;
      ASSERT_TRUE(device->inverse_kinematics(q, joints));
      ++tried;
      below +=
          q[2] + geometry.neutral_height < geometry.crank * std::sin(joints.minCoeff()) ? 1 : 0;
      ASSERT_TRUE(device->forward_kinematics(joints, back)) << crank << " " << q.transpose();
      EXPECT_LT((back - q).norm(), 1e-9);
    }
  }
  std::filesystem::remove(file);
  EXPECT_GT(tried, 1000);
  EXPECT_GT(below, 50);
}

// What the device file claims.
TEST(DeltaTactor, ReachesTenMillimetresEachWay) {
  const auto device = shipped("delta-schorr");
  for (double x = -5.0; x <= 5.0; x += 1.0) {
    for (double y = -5.0; y <= 5.0; y += 1.0) {
      for (double z = -3.0; z <= 7.0; z += 1.0) {
        const Configuration q = Vector3(x, y, z) * mm;
        EXPECT_TRUE(device->reachable(q)) << x << " " << y << " " << z;
      }
    }
  }
}

TEST(CablePlatform, WinchesWindWhatTheCablesLose) {
  const auto device = shipped("cable-prattichizzo");
  const CablePlatformGeometry& geometry =
      dynamic_cast<const CablePlatform&>(device->kinematics()).geometry();
  std::mt19937 random(6);
  std::array<Vector3, 9> neutral;
  device->linkage(Configuration::Zero(3), neutral);
  for (int i = 0; i < 300; ++i) {
    const Configuration q = random_reachable(*device, random);
    std::array<Vector3, 9> points;
    device->linkage(q, points);
    JointAngles joints;
    ASSERT_TRUE(device->inverse_kinematics(q, joints));
    for (std::size_t k = 0; k < 3; ++k) {
      const double lost =
          (neutral[3 * k] - neutral[3 * k + 2]).norm() - (points[3 * k] - points[3 * k + 2]).norm();
      EXPECT_NEAR(joints[static_cast<int>(k)] * geometry.winch_radius, lost, 1e-12);
    }
  }
}

// Any small motion costs the spring what the cables do: by differences of lengths and energy.
TEST(CablePlatform, TensionsBalanceTheSpring) {
  const auto device = shipped("cable-prattichizzo");
  const auto& cables = dynamic_cast<const CablePlatform&>(device->kinematics());
  const CablePlatformGeometry& geometry = cables.geometry();
  const auto energy = [&](const Configuration& q) {
    const double pressed = geometry.spring_length - geometry.neutral_height + q[2];
    return 0.5 * geometry.spring_stiffness * pressed * pressed +
           0.5 * geometry.spring_bending * (q[0] * q[0] + q[1] * q[1]);
  };
  std::mt19937 random(7);
  for (int i = 0; i < 300; ++i) {
    const Configuration q = random_reachable(*device, random);
    Vector3 tension;
    ASSERT_TRUE(cables.tensions(q, tension));
    EXPECT_GE(tension.minCoeff(), geometry.least_tension - 1e-9);
    for (int k = 0; k < 3; ++k) {
      Configuration a = q;
      Configuration b = q;
      const double step = k == 2 ? 1e-6 : 1e-5;
      a[k] += step;
      b[k] -= step;
      JointAngles wound_a;
      JointAngles wound_b;
      ASSERT_TRUE(cables.inverse_kinematics(a, wound_a));
      ASSERT_TRUE(cables.inverse_kinematics(b, wound_b));
      const double work =
          geometry.winch_radius * tension.dot(Vector3(wound_a - wound_b)) / (2.0 * step);
      const double cost = (energy(a) - energy(b)) / (2.0 * step);
      EXPECT_NEAR(work, cost, 1e-6 * (1.0 + std::abs(cost)));
    }
  }
}

TEST(CablePlatform, TiltsTwentyDegreesWhereItPresses) {
  const auto device = shipped("cable-prattichizzo");
  for (double travel = 2.0; travel <= 6.0; travel += 1.0) {
    for (int direction = 0; direction < 360; direction += 10) {
      Configuration q(3);
      q << 20.0 * deg * std::cos(direction * deg), 20.0 * deg * std::sin(direction * deg),
          travel * mm;
      EXPECT_TRUE(device->reachable(q)) << direction << " " << travel;
    }
  }
}

}  // namespace
}  // namespace softfinger
