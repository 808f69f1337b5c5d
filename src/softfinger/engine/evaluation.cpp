#include "softfinger/engine/evaluation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "softfinger/base/error.hpp"
#include "softfinger/engine/device_loop.hpp"
#include "softfinger/engine/finger_loop.hpp"
#include "softfinger/finger/strain_energy.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {
namespace {

void check_connectivity(const FingerModel& wearer, const FingerModel& model) {
  if (wearer.mesh.tetrahedra == model.mesh.tetrahedra &&
      wearer.sample_nodes == model.sample_nodes && wearer.node_is_rigid == model.node_is_rigid) {
    return;
  }
  throw InputError(
      fmt::format("{}: its mesh is not connected as that of {}; a wearer may have another [size], "
                  "other constants or moved nodes, but the same elements and groups",
                  wearer.file.string(), model.file.string()));
}

/// What judges one finger's device.
class Judge {
 public:
  Judge(const std::shared_ptr<const FingerModel>& model,
        const std::shared_ptr<const FingerModel>& wearer,
        const std::shared_ptr<const Device>& device)
      : model_energy_(model),
        wearer_energy_(wearer),
        twin_(wearer, device),
        lagged_(wearer, device) {
    virtual_densities_.resize(model_energy_.elements());
    twin_densities_.resize(wearer_energy_.elements());
    servo_q_ = device->home();
  }

  void judge(const FingerLoop& loop, const DeviceLoop& device, Evaluation& answer) {
    const TickRecord& tick = device.record();
    const double friction = loop.contact().friction_coefficient;
    const double elapsed = std::max(0.0, tick.time - time_);
    time_ = tick.time;
    EvaluatedFrame frame;
    frame.finger = static_cast<std::size_t>(tick.finger);
    frame.time = tick.time;
    frame.virtual_force = loop.contact().normal_force;
    if (loop.contact().contact_count > 0) {
      model_energy_.densities(loop.simulation().positions(), virtual_densities_);
    }
    frame.commanded = press(twin_, tick.command.configuration, friction, elapsed, loop, answer);
    frame.twin_force = twin_.contact().normal_force;
    answer.commanded.add(frame.commanded);
    JointAngles joints;
    if (device.actuator().read_servo_joints(joints)) {
      // Between two commands the joints may stand for no pose of the workspace; the last one stays.
      Configuration q;
      if (device.device().forward_kinematics(joints, q)) servo_q_ = q;
      frame.lagged = press(lagged_, servo_q_, friction, elapsed, loop, answer);
      answer.lagged.add(*frame.lagged);
    } else {
      answer.has_lagged = false;
    }
    answer.frames.push_back(frame);
  }

 private:
  RenderingMeasures press(Twin& twin, const Configuration& q, double friction, double elapsed,
                          const FingerLoop& loop, Evaluation& answer) {
    if (!twin.press(q, friction, elapsed).converged) ++answer.unconverged;
    if (loop.contact().contact_count > 0 && twin.contact().contact_count > 0) {
      wearer_energy_.densities(twin.positions(), twin_densities_);
    }
    return compare({loop.contact(), virtual_densities_, model_energy_.volumes()},
                   {twin.contact(), twin_densities_, wearer_energy_.volumes()});
  }

  StrainEnergy model_energy_, wearer_energy_;
  Twin twin_, lagged_;
  std::vector<double> virtual_densities_, twin_densities_;
  Configuration servo_q_;
  double time_ = 0.0;
};

}  // namespace

Evaluation evaluate(const EvaluationOptions& options, const std::atomic<bool>& stop,
                    const RunObserver& observer) {
  RunOptions run = options.run;
  run.as_fast_as_possible = true;
  run.port = "emulator";
  const std::shared_ptr<const RunSetup> setup = load_setup(run);
  std::shared_ptr<const FingerModel> wearer;
  if (options.wearer) wearer = FingerModel::load(*options.wearer);
  std::vector<Judge> judges;
  Evaluation answer;
  answer.has_lagged = true;
  for (std::size_t i = 0; i < setup->models.size(); ++i) {
    const std::string& name = setup->scene.fingers[i].name;
    if (!setup->devices[i]) {
      throw InputError(fmt::format("{}: finger {} has no device to judge; give it one, or --device",
                                   setup->scene.file.string(), name));
    }
    if (wearer) check_connectivity(*wearer, *setup->models[i]);
    judges.emplace_back(setup->models[i], wearer ? wearer : setup->models[i], setup->devices[i]);
    answer.fingers.push_back(name);
  }
  SceneRun::Hooks hooks;
  hooks.on_tick = [&](std::size_t finger, const FingerLoop& loop, const DeviceLoop& device) {
    judges[finger].judge(loop, device, answer);
  };
  answer.run = run_headless(setup, run, stop, observer, std::move(hooks));
  return answer;
}

}  // namespace softfinger
