#include "exploration.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "recovery.hpp"
#include "softfinger/actuation/actuator.hpp"
#include "softfinger/base/histogram.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/finger/finger_model.hpp"
#include "softfinger/finger/finger_simulation.hpp"
#include "softfinger/loop/finger_loop.hpp"
#include "softfinger/matching/surface_following.hpp"
#include "softfinger/scene/scene.hpp"
#include "softfinger/threads/thread_clock.hpp"
#include "violent_motion.hpp"

namespace softfinger {
namespace {

constexpr int kScrambles = 100;

struct Tally {
  long steps = 0;
  long unconverged = 0;
  long not_finite = 0;
  long commands = 0;
  long out_of_bounds = 0;
  double worst_residual = 0.0;
  double max_normal_force = 0.0;  // N
  std::vector<long> iterations = std::vector<long>(64, 0);
  Histogram step_time;

  [[nodiscard]] int iterations_at(double fraction) const {
    const double wanted = fraction * static_cast<double>(steps);
    double seen = 0.0;
    for (std::size_t count = 0; count < iterations.size(); ++count) {
      seen += static_cast<double>(iterations[count]);
      if (seen >= wanted) return static_cast<int>(count);
    }
    return static_cast<int>(iterations.size());
  }
};

bool all_finite(const FingerSimulation& simulation) {
  const auto finite = [](const Vector3& v) { return v.allFinite(); };
  return std::ranges::all_of(simulation.positions(), finite) &&
         std::ranges::all_of(simulation.velocities(), finite) &&
         simulation.bone_pose().rotation.allFinite() &&
         simulation.bone_pose().translation.allFinite() &&
         std::isfinite(simulation.contact().normal_force);
}

/// One device with its tick, and the bounds its commands are held to.
class RenderedDevice {
 public:
  RenderedDevice(const std::filesystem::path& file, int samples)
      : device_(load_device(file)),
        rendering_(device_, samples),
        actuator_(device_, {.port = "emulator", .simulated_time = true}),
        period_(1.0 /
                (device_->settings().transport ? device_->settings().transport->rate : 30.0)) {}

  /// Ticks if the device clock is due in the step that ends at `time`.
  void advance(const ContactSet& contact, double time, Tally& tally) {
    if (time < static_cast<double>(ticks_) * period_) return;
    ++ticks_;
    const RenderedSurface& wanted = rendering_.tick(contact, period_);
    const FormedCommand& command = actuator_.command(
        {.configuration = wanted.configuration, .touching = contact.contact_count > 0}, time);
    ++tally.commands;
    if (!within_bounds(command, time)) ++tally.out_of_bounds;
    last_joints_ = command.joints;
    last_time_ = time;
  }

 private:
  bool within_bounds(const FormedCommand& command, double time) const {
    constexpr double kSlack = 1e-9;
    const JointLimits& limits = device_->joint_limits();
    if (!command.joints.allFinite() || !command.configuration.allFinite()) return false;
    if ((command.joints.array() < limits.min.array() - kSlack).any()) return false;
    if ((command.joints.array() > limits.max.array() + kSlack).any()) return false;
    if (!last_joints_) return true;
    const double reach = limits.max_rate * (time - last_time_) + kSlack;
    return (command.joints - *last_joints_).cwiseAbs().maxCoeff() <= reach;
  }

  std::shared_ptr<const Device> device_;
  SurfaceFollowing rendering_;
  Actuator actuator_;
  double period_;  // s
  long ticks_ = 0;
  std::optional<JointAngles> last_joints_;
  double last_time_ = 0.0;
};

Tally explore(const std::filesystem::path& file, long steps, std::uint64_t seed, bool limited) {
  const Scene scene = load_scene(file);
  const SceneFinger& finger = scene.fingers.front();
  const double time_step = 1.0 / scene.simulation_rate;
  ViolentMotion motion(finger.waypoints, seed);
  FingerSimulation simulation(FingerModel::load(finger.model), scene.objects, time_step);
  std::optional<RenderedDevice> device;
  if (finger.device) {
    device.emplace(*finger.device, static_cast<int>(simulation.contact().samples.size()));
  }
  Pose X_WFt = motion.sample(0.0);
  simulation.reset(X_WFt);
  const double furthest = limited ? kMaxTrackedSpeed * time_step : 1e9;
  const double greatest_turn = limited ? kMaxTrackedAngularSpeed * time_step : 1e9;

  Tally tally;
  for (long k = 1; k <= steps; ++k) {
    const double time = static_cast<double>(k) * time_step;
    X_WFt = moved_towards(X_WFt, motion.sample(time), furthest, greatest_turn);
    const double began = thread_cpu_time();
    const StepSummary step = simulation.step(X_WFt, time);
    tally.step_time.add(thread_cpu_time() - began);
    ++tally.steps;
    ++tally.iterations[std::min(static_cast<std::size_t>(step.iterations),
                                tally.iterations.size() - 1)];
    if (!step.converged) ++tally.unconverged;
    if (!all_finite(simulation)) ++tally.not_finite;
    tally.worst_residual = std::max(tally.worst_residual, step.relative_residual);
    tally.max_normal_force = std::max(tally.max_normal_force, simulation.contact().normal_force);
    if (device) device->advance(simulation.contact(), time, tally);
  }
  return tally;
}

void print(const std::string& name, const Tally& tally) {
  fmt::print(
      "{:<8} {:>8} steps {:>6} unconverged {:>3} not finite  worst residual {:.1e}  iterations {} "
      "/ "
      "{} / {}  step {:.3f} / {:.3f} / {:.3f} ms  force to {:.1f} N  {} commands, {} out of "
      "bounds\n",
      name, tally.steps, tally.unconverged, tally.not_finite, tally.worst_residual,
      tally.iterations_at(0.5), tally.iterations_at(0.99), tally.iterations_at(1.0),
      tally.step_time.percentile(50) * 1e3, tally.step_time.percentile(99) * 1e3,
      tally.step_time.max() * 1e3, tally.max_normal_force, tally.commands, tally.out_of_bounds);
}

void print(const std::string& what, const Recovery& recovery) {
  fmt::print(
      "{}: {} trials {} unconverged {} not finite {} elements inside out  iterations to {}  "
      "ends within {:.1e} mm{}\n",
      what, recovery.trials, recovery.unconverged, recovery.not_finite, recovery.inverted,
      recovery.iterations, recovery.apart / mm,
      recovery.max_force > 0.0 ? fmt::format("  force to {:.1f} N", recovery.max_force) : "");
}

}  // namespace

bool explore_violently(long steps, std::uint64_t seed) {
  fmt::print("iterations and step times: median / 99 % / most; seed {}\n", seed);
  bool sound = true;
  const std::filesystem::path root = source_folder();
  for (const bool limited : {true, false}) {
    fmt::print("tracked pose {}\n",
               limited ? "held to the speed that a run allows" : "as it comes");
    for (const std::string name : {"plane", "edge", "sphere"}) {
      const Tally tally =
          explore(root / "scenes" / (name + ".toml"), std::max(1L, steps / 6), seed, limited);
      print(name, tally);
      sound = sound && tally.not_finite == 0 && tally.out_of_bounds == 0 &&
              tally.unconverged * 1000 <= tally.steps;
    }
  }
  for (const std::string name : {"index", "index-medium"}) {
    const auto model = FingerModel::load(root / "fingers" / (name + ".toml"));
    const Recovery scrambled = scramble(*model, kScrambles, seed);
    print(name + ", nodes scrambled by 5 mm", scrambled);
    const Recovery pressed = press_hard(*model);
    print(name + ", pressed to 4 mm", pressed);
    sound = sound && scrambled.sound() && pressed.sound();
  }
  return sound;
}

}  // namespace softfinger
