// Objective "surface_and_force" over poses of the finger on planes and spheres: what a twin pressed
// from afar feels at the configuration found, against the virtual contact.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>
#include <vector>

#include "project.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/matching/contact_surface_matching.hpp"
#include "softfinger/objectives/force_aware_matching.hpp"
#include "softfinger/twin/skin_comparison.hpp"

namespace softfinger {
namespace {

constexpr double kStep = 1e-3;

struct PressedPose {
  Matrix3 R_WF;
  double depth;   ///< of the bone after first touch, m
  double radius;  ///< of the sphere; 0: plane
};

/// The seed is part of the test: these are always the same poses.
std::vector<PressedPose> pressed_poses(int count) {
  std::mt19937 random(2015);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<PressedPose> poses;
  for (int k = 0; k < count; ++k) {
    const double tilt = 20.0 * deg * unit(random);
    const double azimuth = 2.0 * std::numbers::pi * unit(random);
    const double depth = (0.5 + 1.5 * unit(random)) * mm;
    const double radius = k % 2 == 0 ? 0.0 : (8.0 + 12.0 * unit(random)) * mm;
    poses.push_back(
        {exp_rotation(tilt * Vector3(std::cos(azimuth), std::sin(azimuth), 0.0)), depth, radius});
  }
  return poses;
}

/// The finger that the tracked pose moves as if it held the bone itself.
std::shared_ptr<const FingerModel> tightly_held(const std::string& name) {
  auto model =
      std::make_shared<FingerModel>(*FingerModel::load(kProject / "fingers" / (name + ".toml")));
  model->coupling = {1e5, 100.0, 20.0, 0.02};
  return model;
}

/// Presses the finger down on the object and waits until it rests.
ContactSet virtual_contact(const std::shared_ptr<const FingerModel>& model,
                           const PressedPose& pose) {
  VirtualObject object;
  object.name = "object";
  if (pose.radius > 0.0) object.shape = Ball{pose.radius};
  Waypoint still;
  if (pose.radius > 0.0) still.pose.translation.z() = -pose.radius;
  object.motion = Trajectory({still});
  double low = -0.1;
  double high = 0.1;
  const Pose X_OW = still.pose.inverse();
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    double gap = 1.0;
    for (const int node : model->sample_nodes) {
      const Vector3 p =
          pose.R_WF * model->mesh.nodes[static_cast<std::size_t>(node)] + Vector3(0.0, 0.0, middle);
      gap = std::min(gap, signed_distance(object.shape, X_OW * p).distance);
    }
    (gap > 0.0 ? high : low) = middle;
  }
  FingerSimulation simulation(model, {&object, 1}, kStep);
  Pose X_WFt{pose.R_WF, Vector3(0.0, 0.0, high + 0.2 * mm)};
  simulation.reset(X_WFt);
  const double bottom = high - pose.depth;
  for (int step = 1; step <= 220; ++step) {
    X_WFt.translation.z() = std::max(bottom, X_WFt.translation.z() - 0.02 * mm);
    simulation.step(X_WFt, step * kStep);
  }
  return simulation.contact();
}

Configuration surface_match(const std::shared_ptr<const Device>& device,
                            const ContactSet& contact) {
  std::vector<Vector3> points;
  std::vector<std::uint8_t> in_contact;
  std::vector<double> gaps;
  for (const ContactSample& sample : contact.samples) {
    points.push_back(sample.position_F);
    in_contact.push_back(sample.in_contact ? 1 : 0);
    gaps.push_back(sample.gap);
  }
  ContactSurfaceMatching matching(device, static_cast<int>(points.size()));
  return matching.solve({points, in_contact, {}, gaps}, {}).configuration;
}

struct Outcome {
  std::vector<double> errors;
  int unreachable = 0, unconverged = 0;
  [[nodiscard]] double percentile(double part) const {
    std::vector<double> sorted = errors;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
  }
};

Outcome render_poses(const std::string& finger, int count) {
  const auto device = load_device(kProject / "devices" / "thimble-3rrs.toml");
  const auto model = tightly_held(finger);
  const auto samples = static_cast<int>(model->sample_nodes.size());
  Outcome outcome;
  int number = 0;
  for (const PressedPose& pose : pressed_poses(count)) {
    const ContactSet contact = virtual_contact(model, pose);
    const Configuration start = surface_match(device, contact);
    ForceAwareMatching force(model, device, samples);
    Configuration q;
    for (int frame = 0; frame < 5; ++frame) {
      q = force.match(contact, start, contact.friction_coefficient, 1.0 / 30.0, {}).configuration;
    }
    Twin judge(model, device);
    if (!judge.press(q, contact.friction_coefficient, 0.0).converged) ++outcome.unconverged;
    const double error =
        std::abs(judge.contact().normal_force - contact.normal_force) / contact.normal_force;
    // At a limit of its workspace the device can do no more.
    Eigen::VectorXd values(device->constraint_count());
    Eigen::MatrixXd jacobian(device->constraint_count(), 3);
    const bool at_limit = !device->constraints(q, values, jacobian) || values.maxCoeff() > -1e-6;
    ++number;
    if (at_limit && error > 0.01) {
      ++outcome.unreachable;
      std::cout << "unreachable: pose " << number << ", error " << error << "\n";
      continue;
    }
    outcome.errors.push_back(error);
  }
  std::cout << finger << ": " << outcome.errors.size() << " poses, force error median "
            << outcome.percentile(0.5) << ", 90 % " << outcome.percentile(0.9) << ", worst "
            << outcome.percentile(1.0) << "\n";
  return outcome;
}

TEST(ForceAwareMatching, MeetsTheForceOnPlanesAndSpheres) {
  const Outcome outcome = render_poses("index", 100);
  EXPECT_LE(outcome.percentile(0.5), 0.005);
  EXPECT_LE(outcome.percentile(0.9), 0.02);
  EXPECT_LE(outcome.unreachable, 20);
  EXPECT_EQ(outcome.unconverged, 0);
}

TEST(ForceAwareMatching, MeetsTheForceOnAFinerFinger) {
  const Outcome outcome = render_poses("index-medium", 8);
  EXPECT_LE(outcome.percentile(0.5), 0.005);
  EXPECT_LE(outcome.percentile(0.9), 0.02);
  EXPECT_EQ(outcome.unconverged, 0);
}

/// Stress error and force error of an objective on a sphere that the disk cannot follow.
std::pair<double, double> errors_on_a_sphere(const ForceAwareOptions& options) {
  const auto device = load_device(kProject / "devices" / "thimble-3rrs.toml");
  const auto model = tightly_held("index");
  VirtualObject object;
  object.name = "object";
  object.shape = Ball{8.0 * mm};
  Waypoint still;
  still.pose.translation.z() = -8.0 * mm;
  object.motion = Trajectory({still});
  FingerSimulation simulation(model, {&object, 1}, kStep);
  const double lowest =
      std::min_element(model->mesh.nodes.begin(), model->mesh.nodes.end(),
                       [](const Vector3& a, const Vector3& b) { return a.z() < b.z(); })
          ->z();
  Pose X_WFt{exp_rotation({0.1, 0.15, 0.0}), Vector3(0.0, 0.0, -lowest)};
  simulation.reset(X_WFt);
  for (int step = 1; step <= 200; ++step) {
    X_WFt.translation.z() = std::max(-lowest - 1.5 * mm, X_WFt.translation.z() - 0.02 * mm);
    simulation.step(X_WFt, step * kStep);
  }
  const ContactSet& contact = simulation.contact();
  std::vector<Vector3> nodes_F(model->mesh.nodes.size());
  transform(simulation.bone_pose().inverse(), simulation.positions(), nodes_F);

  const Configuration start = surface_match(device, contact);
  ForceAwareMatching matching(model, device, static_cast<int>(contact.samples.size()), options);
  for (int frame = 0; frame < 8; ++frame) {
    matching.match(contact, start, contact.friction_coefficient, 1.0 / 30.0, {}, nodes_F);
  }
  SkinComparison comparison(model, model, SkinComparison::Depth::kTissue);
  comparison.take_virtual(contact, nodes_F);
  const RenderingMeasures measures =
      comparison.compare(matching.twin().contact(), matching.twin().positions());
  return {measures.stress_error, measures.normal_force_error};
}

TEST(ForceAwareMatching, EachObjectiveIsBestAtItsOwn) {
  const auto [stress_of_force, force_of_force] = errors_on_a_sphere({});
  const auto [stress_of_stress, force_of_stress] = errors_on_a_sphere(ForceAwareOptions::stress());
  std::cout << "sphere: stress error " << stress_of_force << " by force, " << stress_of_stress
            << " by stress; force error " << force_of_force << " by force, " << force_of_stress
            << " by stress\n";
  EXPECT_LT(stress_of_stress, 0.99 * stress_of_force);
  EXPECT_LT(force_of_force, 0.01);
  EXPECT_LT(force_of_force, force_of_stress);
}

}  // namespace
}  // namespace softfinger
