// A wearer who is not like the model: what a measured force makes of it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <vector>

#include "project.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/loop/emulated_force_sensor.hpp"
#include "softfinger/loop/travel_offset.hpp"
#include "softfinger/matching/surface_following.hpp"
#include "softfinger/objectives/twin_correction.hpp"
#include "softfinger/sensing/force_sensor_emulator.hpp"

namespace softfinger {
namespace {

constexpr double kSimulationStep = 1e-3;
constexpr int kStepsPerFrame = 33;
constexpr int kFrames = 150;  // two presses

struct Wearer {
  const char* name;
  double size, stiffness;
};

std::shared_ptr<const FingerModel> finger_of(const FingerModel& model, const Wearer& wearer) {
  auto finger = std::make_shared<FingerModel>(model);
  for (Vector3& node : finger->mesh.nodes) node *= wearer.size;
  for (double& area : finger->sample_rest_areas) area *= wearer.size * wearer.size;
  for (auto& material : finger->materials) material.youngs_modulus *= wearer.stiffness;
  finger->strain_limits.stiffness *= wearer.stiffness;
  return finger;
}

/// The finger presses 0 to 2 mm at 0.4 Hz and tilts by up to 0.3 rad; radius 0: plane.
Pose tracked_pose(const FingerModel& model, double radius, double time) {
  const double turn = 2.0 * std::numbers::pi;
  Pose pose;
  pose.rotation =
      exp_rotation({0.2 * std::sin(0.11 * turn * time), 0.3 * std::sin(0.17 * turn * time), 0.0});
  double touch = -1.0;
  for (const int node : model.sample_nodes) {
    const Vector3 p = pose.rotation * model.mesh.nodes[static_cast<std::size_t>(node)];
    const double aside = p.head<2>().squaredNorm();
    if (radius > 0.0 && aside > radius * radius) continue;
    const double rise = radius > 0.0 ? std::sqrt(radius * radius - aside) - radius : 0.0;
    touch = std::max(touch, rise - p.z());
  }
  pose.translation.z() = touch - 1.0 * mm * (1.0 - std::cos(0.4 * turn * time));
  return pose;
}

struct Frame {
  ContactSet contact;    ///< virtual
  Configuration wanted;  ///< by the objective
};

constexpr double kElapsed = kStepsPerFrame * kSimulationStep;

std::vector<Frame> virtual_frames(const std::shared_ptr<const FingerModel>& model,
                                  const std::shared_ptr<const Device>& device, double radius) {
  VirtualObject object;
  object.name = "object";
  Waypoint still;
  if (radius > 0.0) {
    object.shape = Ball{radius};
    still.pose.translation.z() = -radius;
  }
  object.motion = Trajectory({still});
  FingerSimulation simulation(model, {&object, 1}, kSimulationStep);
  simulation.reset(tracked_pose(*model, radius, 0.0));
  SurfaceFollowing surface(device, static_cast<int>(model->sample_nodes.size()));
  TwinCorrection force(model, device);
  std::vector<Frame> frames;
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int step = 1; step <= kStepsPerFrame; ++step) {
      const double time = (frame * kStepsPerFrame + step) * kSimulationStep;
      simulation.step(tracked_pose(*model, radius, time), time);
    }
    const ContactSet& contact = simulation.contact();
    frames.push_back(
        {contact,
         force.tick(contact, {}, surface.tick(contact, kElapsed), kElapsed).configuration});
  }
  return frames;
}

/// Errors of the wearer's normal force against the virtual one, as fractions, over frames that
/// press with 0.1 N at least, the least first; the first ten frames are left out.
std::vector<double> force_errors(const std::vector<Frame>& frames,
                                 const std::shared_ptr<const FingerModel>& model,
                                 const std::shared_ptr<const Device>& device, const Wearer& wearer,
                                 bool measured, double noise) {
  TravelOffset offset(model, device);
  EmulatedForceSensor plant(finger_of(*model, wearer), device);
  FaultyForce says(noise, 1);
  ForceReading reading;
  std::vector<double> errors;
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    const ContactSet& contact = frames[frame].contact;
    const double friction = contact.friction_coefficient;
    if (measured && frame > 0) offset.update(reading, friction, kElapsed);
    reading.configuration = offset.corrected(frames[frame].wanted);
    reading.normal_force = *says.reading(plant.press(reading.configuration, friction, kElapsed));
    if (frame >= 10 && contact.normal_force > 0.1) {
      errors.push_back(std::abs(plant.force() - contact.normal_force) / contact.normal_force);
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

double percentile(const std::vector<double>& sorted, double part) {
  return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
}

TEST(TravelOffset, BringsTheForceBackOnOtherWearers) {
  auto model =
      std::make_shared<FingerModel>(*FingerModel::load(kProject / "fingers" / "index.toml"));
  model->coupling = {1e5, 100.0, 20.0, 0.02};
  const auto device = load_device(kProject / "devices" / "thimble-3rrs.toml");
  for (const double radius : {0.0, 12.0 * mm}) {
    const std::vector<Frame> frames = virtual_frames(model, device, radius);
    for (const Wearer& wearer :
         {Wearer{"larger", 1.05, 1.0}, Wearer{"smaller", 0.95, 1.0}, Wearer{"stiffer", 1.0, 1.5}}) {
      const auto open = force_errors(frames, model, device, wearer, false, 0.0);
      const auto closed = force_errors(frames, model, device, wearer, true, 0.0);
      const auto noisy = force_errors(frames, model, device, wearer, true, 0.02);
      std::cout << wearer.name << (radius > 0.0 ? ", sphere: " : ", plane: ")
                << "force error median " << percentile(open, 0.5) << " without, "
                << percentile(closed, 0.5) << " (90 % " << percentile(closed, 0.9) << ") with, "
                << percentile(noisy, 0.5) << " (90 % " << percentile(noisy, 0.9)
                << ") with noise\n";
      EXPECT_GT(percentile(open, 0.5), 0.2);
      EXPECT_LE(percentile(closed, 0.5), 0.03);
      // Stable: noise makes no swings of its own.
      EXPECT_LE(percentile(noisy, 0.5), 0.03);
      EXPECT_LE(percentile(noisy, 0.9), 0.15);
    }
  }
}

}  // namespace
}  // namespace softfinger
