#include "softfinger/session/virtual_side.hpp"

#include <fmt/core.h>

#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/loop/scene_loop.hpp"
#include "softfinger/session/run_objects.hpp"
#include "softfinger/session/run_tracker.hpp"

namespace softfinger {
namespace {

/// A run of this scene as far as a tracker needs one.
RunSetup setup_of(const Scene& scene, const std::shared_ptr<const FingerModel>& model) {
  RunSetup setup;
  setup.scene = scene;
  setup.models = {model};
  setup.devices = {nullptr};
  setup.ceilings = {nullptr};
  setup.notices.resize(1);
  setup.registrations.resize(1);
  setup.tracker_directories = {scene.file.parent_path()};
  return setup;
}

/// Steps until the tracker ends.
std::int64_t step_count(const Scene& scene, const RunTracker& tracker) {
  const std::optional<double> end = tracker.end_time();
  if (!end) {
    throw InputError(
        fmt::format("{}: tracker {} has no end; give a script, a CSV file or a "
                    "recording",
                    scene.file.string(), scene.fingers.front().tracker));
  }
  // As in a run: a whole number of steps up to rounding is that number.
  return static_cast<std::int64_t>(std::ceil(*end * scene.simulation_rate - 1e-6));
}

}  // namespace

std::size_t VirtualSide::bytes() const {
  std::size_t sum = sizeof(VirtualSide);
  for (const Tick& tick : ticks) {
    sum += sizeof(Tick) + tick.contact.samples.capacity() * sizeof(ContactSample) +
           tick.contact.triangles.capacity() * sizeof(TriangleContact) +
           tick.nodes_W.capacity() * sizeof(Vector3);
  }
  return sum;
}

VirtualSide run_virtual_side(const Scene& scene, const std::shared_ptr<const FingerModel>& model,
                             double device_rate) {
  if (scene.fingers.size() != 1) {
    throw InputError(
        fmt::format("{}: has {} fingers; expected one", scene.file.string(), scene.fingers.size()));
  }
  const RunSetup setup = setup_of(scene, model);
  RunOptions options;
  options.as_fast_as_possible = true;
  RunTracker tracker(setup, 0, options, false);
  VirtualSide side;
  side.model = model;
  side.device_rate = device_rate;
  side.steps = step_count(scene, tracker);
  RunObjects wanted(setup.scene);
  FingerChain chain({.model = model,
                     .objects = setup.scene.objects,
                     .simulation_rate = scene.simulation_rate,
                     .hand = scene.fingers.front().hand});
  SceneLoop loop(setup.scene.objects, scene.gravity, scene.simulation_rate, nullptr);
  loop.add(chain);
  DeviceClock clock(scene.simulation_rate, device_rate);
  loop.start(wanted.sample(0, 0.0));
  chain.start(TrackedInput(tracker.sample(0.0)));
  for (std::int64_t step = 1; step <= side.steps; ++step) {
    const double time = static_cast<double>(step) / scene.simulation_rate;
    const TrackedInput tracked(tracker.sample(time));
    loop.step(step, {&tracked, 1}, wanted.sample(step, time));
    if (clock.ticks(step)) {
      const VirtualFinger finger = chain.virtual_finger();
      const StepRecord& record = chain.loop().record();
      side.ticks.push_back({.step = step,
                            .time = record.time,
                            .tracked = record.tracked.valid,
                            .contact = finger.contact,
                            .nodes_W = {finger.nodes_W.begin(), finger.nodes_W.end()},
                            .X_WF = finger.X_WF});
    }
    side.summary.add(chain.seal());
  }
  return side;
}

Evaluation judge_on(const VirtualSide& side, const JudgedDevice& device) {
  const std::shared_ptr<const Device>& worn = device.worn.device;
  const std::shared_ptr<const FingerModel>& wearer = device.wearer ? device.wearer : side.model;
  DeviceLoopOptions options;
  options.actuator.port = "emulator";
  options.actuator.device_file = device.file;
  options.actuator.simulated_time = true;
  options.actuator.ceiling = device.worn.ceiling;
  options.objective = device.objective;
  options.wearer = device.wearer;
  DeviceLoop loop(0, worn, side.model, options);
  RenderingJudge judge(side.model, wearer, worn, device.sides);
  Evaluation answer;
  answer.has_lagged = device.sides.lagged;
  answer.has_loaded = device.sides.loaded;
  answer.linear_motors = {worn->joint_limits().linear};
  FingerSummary summary = side.summary;
  for (const VirtualSide::Tick& tick : side.ticks) {
    const VirtualFinger finger{tick.contact, tick.nodes_W, tick.X_WF};
    summary.add(loop.tick({.step = tick.step, .time = tick.time, .tracked = tick.tracked}, finger));
    judge.judge(finger, loop, answer);
  }
  loop.actuator().finish();
  summary.commands_sent = loop.actuator().commands_sent();
  answer.run.steps = side.steps;
  answer.run.all = summary;
  if (device.wearer) judge.check_cover();
  return answer;
}

}  // namespace softfinger
