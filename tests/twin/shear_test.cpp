// Tangential forces of the twin: the derivative against differences, symmetry, and Coulomb's law.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../support/box_finger.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {
namespace {

/// A disk or a ball that three drives move: x, y, z from where it touches the block's lower face.
std::shared_ptr<const Device> tactor_under_block(const std::string& surface) {
  const std::string text =
      "kind = \"linear_drives\"\n[mount]\ntranslation_mm = [0.0, 0.0, -9.0]\n"
      "[[drive]]\nname = \"x_mm\"\naxis = [1.0, 0.0, 0.0]\njoint_mm = [-5.0, 5.0]\n"
      "[[drive]]\nname = \"y_mm\"\naxis = [0.0, 1.0, 0.0]\njoint_mm = [-5.0, 5.0]\n"
      "[[drive]]\nname = \"travel_mm\"\naxis = [0.0, 0.0, 1.0]\njoint_mm = [-3.0, 7.0]\n"
      "[limits]\njoint_rate_mm_per_s = 100.0\n[[surface]]\n" +
      surface;
  return load_device("tactor.toml", text, 0.0);
}

std::shared_ptr<const Device> disk_under_block() {
  static const auto device = tactor_under_block("type = \"disk\"\nradius_mm = 20.0\n");
  return device;
}

std::shared_ptr<const Device> ball_under_block() {
  static const auto device =
      tactor_under_block("type = \"sphere\"\nradius_mm = 6.0\norigin_mm = [0.0, 0.0, -6.0]\n");
  return device;
}

/// In mm; depth from where the surface touches the block.
Configuration sheared(double x, double y, double depth) {
  Configuration q(3);
  q << x * mm, y * mm, (2.0 + depth) * mm;
  return q;
}

std::shared_ptr<const FingerModel> plain_block() {
  const std::shared_ptr<FingerModel> model = testing_support::box_finger();
  model->feature_contact = false;  // which is seen from where the skin was
  return model;
}

/// Pressed by 1 mm, then moved aside by (x, y) mm in a frame that is not kept.
Twin pressed_and_sheared(const std::shared_ptr<const Device>& device, double friction, double x,
                         double y) {
  Twin twin(plain_block(), device);
  twin.press(sheared(0.0, 0.0, 0.5), friction, 0.0);
  twin.press(sheared(0.0, 0.0, 1.0), friction, 0.0);
  twin.press(sheared(0.6 * x, 0.6 * y, 1.0), friction, 0.0);
  twin.begin_frame(friction, 0.0);
  twin.attempt(sheared(x, y, 1.0));
  return twin;
}

void expect_derivatives_as_differences(const std::shared_ptr<const Device>& device, double friction,
                                       double x, double y, double tolerance) {
  Twin twin = pressed_and_sheared(device, friction, x, y);
  const ContactSet& contact = twin.contact();
  TwinForces forces;
  ASSERT_TRUE(twin.forces_and_derivatives(forces));
  EXPECT_LT((forces.normal - normal_force_vector(contact)).norm(), 1e-9);
  EXPECT_LT((forces.tangential - contact.tangential_force_F).norm(), 1e-9);
  const Configuration q = twin.configuration();
  for (int k = 0; k < 3; ++k) {
    const double h = 2e-6;  // limits are known to 1e-5 N
    const auto forces_at = [&](double offset) {
      Configuration near = q;
      near[k] += offset;
      twin.attempt(near);
      return std::array{normal_force_vector(contact), contact.tangential_force_F};
    };
    const auto ahead = forces_at(h);
    const auto behind = forces_at(-h);
    const double size = forces.normal_by_q.norm() + forces.tangential_by_q.norm();
    EXPECT_LT((forces.normal_by_q.col(k) - (ahead[0] - behind[0]) / (2 * h)).norm(),
              tolerance * size)
        << "normal, axis " << k << ", friction " << friction << ", x " << x << ", y " << y;
    EXPECT_LT((forces.tangential_by_q.col(k) - (ahead[1] - behind[1]) / (2 * h)).norm(),
              tolerance * size)
        << "tangential, axis " << k << ", friction " << friction << ", x " << x << ", y " << y;
  }
}

TEST(TwinShear, DerivativesAreThoseOfTheEquilibriumWhereAllSticksAndWhereAllSlides) {
  for (const double friction : {0.3, 0.8}) {
    for (const auto& [x, y] : {std::array{0.05, 0.0}, {-0.03, 0.04}, {3.0, 0.0}, {-2.0, 1.5}}) {
      expect_derivatives_as_differences(disk_under_block(), friction, x, y, 0.015);
      expect_derivatives_as_differences(ball_under_block(), friction, x, y, 0.015);
    }
  }
}

// Where all slides, the tangential force grows with the normal one alone: by mu of it.
TEST(TwinShear, WhatSlidesGrowsWithTheNormalForceByTheCoefficient) {
  for (const double friction : {0.2, 0.5}) {
    Twin twin = pressed_and_sheared(disk_under_block(), friction, 4.0, 0.0);
    ASSERT_NEAR(twin.contact().slip_ratio, 1.0, 1e-3);
    TwinForces forces;
    ASSERT_TRUE(twin.forces_and_derivatives(forces));
    const double normal_rate = forces.normal_by_q.col(2).z();
    EXPECT_GT(normal_rate, 100.0);
    EXPECT_NEAR(forces.tangential_by_q.col(2).x(), friction * normal_rate, 0.02 * normal_rate);
    EXPECT_NEAR(forces.tangential_by_q.col(0).x(), friction * forces.normal_by_q.col(0).z(),
                0.02 * normal_rate);
  }
}

TEST(TwinShear, IsNoneWithoutFrictionAndWithinTheConeWithIt) {
  for (const double friction : {0.0, 0.2, 0.9}) {
    Twin twin(plain_block(), disk_under_block());
    for (const auto& [x, y, depth] :
         {std::array{0.0, 0.0, 0.8}, {0.5, -0.2, 1.0}, {3.0, 1.0, 1.2}, {-1.0, 2.0, 0.4}}) {
      twin.press(sheared(x, y, depth), friction, 0.0);
      const ContactSet& contact = twin.contact();
      ASSERT_GT(contact.normal_force, 0.1);
      EXPECT_LE(contact.tangential_force, 1.01 * friction * contact.normal_force_sum + 1e-9);
      EXPECT_NEAR(contact.tangential_force, contact.tangential_force_F.norm(), 1e-15);
      if (friction > 0.0) continue;
      EXPECT_EQ(contact.tangential_force, 0.0);
    }
  }
}

// The block is its own mirror image but for how it is cut into tetrahedra, by which it leans a
// little when it is pressed.
TEST(TwinShear, PointsTheWayTheSurfaceWentAndTurnsWithIt) {
  const Vector3 pressed =
      pressed_and_sheared(disk_under_block(), 0.5, 0.0, 0.0).contact().tangential_force_F;
  for (const auto& [x, y] : {std::array{0.4, 0.0}, {0.0, 0.4}, {-0.3, 0.2}, {2.0, -2.0}}) {
    const Vector3 there =
        pressed_and_sheared(disk_under_block(), 0.5, x, y).contact().tangential_force_F;
    const Vector3 back =
        pressed_and_sheared(disk_under_block(), 0.5, -x, -y).contact().tangential_force_F;
    const Vector3 way = Vector3(x, y, 0.0).normalized();
    EXPECT_GT((there - pressed).dot(way), 0.97 * (there - pressed).norm()) << x << ' ' << y;
    EXPECT_LT((there + back - 2.0 * pressed).norm(), 0.15 * there.norm()) << x << ' ' << y;
  }
}

TEST(TwinShear, AMirroredMotionHasTheMirroredForce) {
  const std::shared_ptr<FingerModel> mirrored = testing_support::box_finger();
  mirrored->feature_contact = false;
  for (Vector3& node : mirrored->mesh.nodes) node.y() = -node.y();
  for (auto& tetrahedron : mirrored->mesh.tetrahedra) std::swap(tetrahedron[2], tetrahedron[3]);
  for (auto& triangle : mirrored->mesh.triangles) std::swap(triangle[1], triangle[2]);
  for (auto& triangle : mirrored->skin_triangles) std::swap(triangle[1], triangle[2]);
  Twin left(plain_block(), ball_under_block());
  Twin right(mirrored, ball_under_block());
  for (const auto& [x, y, depth] :
       {std::array{0.0, 0.0, 0.9}, {0.2, 0.3, 1.1}, {1.0, -1.5, 1.0}, {-1.0, 0.5, 0.7}}) {
    left.press(sheared(x, y, depth), 0.5, 0.0);
    right.press(sheared(x, -y, depth), 0.5, 0.0);
    Vector3 expected = left.contact().tangential_force_F;
    expected.y() = -expected.y();
    EXPECT_LT((right.contact().tangential_force_F - expected).norm(),
              1e-3 * left.contact().normal_force)
        << x << ' ' << y;
    EXPECT_NEAR(right.contact().slip_ratio, left.contact().slip_ratio, 1e-3);
  }
}

}  // namespace
}  // namespace softfinger
