#include "softfinger/session/evaluation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "softfinger/base/error.hpp"
#include "softfinger/finger/element_loads.hpp"
#include "softfinger/loop/finger_chain.hpp"
#include "softfinger/session/scene_load.hpp"
#include "softfinger/twin/twin.hpp"

namespace softfinger {
namespace {

/// What the tissue of one finger bears.
class Loads {
 public:
  explicit Loads(const std::shared_ptr<const FingerModel>& model)
      : loads_(model), densities_(loads_.size()), stresses_(loads_.size()) {}

  void take(std::span<const Vector3> positions_F) {
    loads_.energy_densities(positions_F, densities_);
    loads_.stresses(positions_F, stresses_);
  }
  [[nodiscard]] TouchedSkin skin(const ContactSet& contact) const {
    return {contact, densities_, stresses_, loads_.volumes()};
  }

 private:
  ElementLoads loads_;
  std::vector<double> densities_;
  std::vector<Stress> stresses_;
};

/// What judges one finger's device.
class Judge {
 public:
  Judge(const std::shared_ptr<const FingerModel>& model,
        const std::shared_ptr<const FingerModel>& wearer,
        const std::shared_ptr<const Device>& device)
      : model_(model), wearer_(wearer), twin_(wearer, device), lagged_(wearer, device) {
    nodes_F_.resize(model->mesh.nodes.size());
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
    frame.virtual_force_sum = loop.contact().normal_force_sum;
    frame.virtual_tangential_F = loop.contact().tangential_force_F;
    if (loop.contact().contact_count > 0) {
      transform(loop.simulation().bone_pose().inverse(), loop.simulation().positions(), nodes_F_);
      model_.take(nodes_F_);
    }
    frame.commanded = press(twin_, tick.command.configuration, friction, elapsed, loop, answer);
    frame.twin_force = twin_.contact().normal_force;
    frame.twin_force_sum = twin_.contact().normal_force_sum;
    frame.twin_tangential_F = twin_.contact().tangential_force_F;
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
      wearer_.take(twin.positions());
    }
    return compare(model_.skin(loop.contact()), wearer_.skin(twin.contact()));
  }

  Loads model_, wearer_;
  Twin twin_, lagged_;
  std::vector<Vector3> nodes_F_;
  Configuration servo_q_;
  double time_ = 0.0;
};

}  // namespace

Evaluation evaluate(const EvaluationOptions& options, const std::atomic<bool>& stop,
                    const RunObserver& observer) {
  RunOptions run = options.run;
  run.as_fast_as_possible = true;
  run.actuator.port = "emulator";
  const std::shared_ptr<const RunSetup> setup = load_unless_stopped(run, stop);
  if (!setup) throw OperationError("evaluate: ended while the scene was loading");
  std::vector<Judge> judges;
  Evaluation answer;
  answer.has_lagged = true;
  for (std::size_t i = 0; i < setup->models.size(); ++i) {
    const std::string& name = setup->scene.fingers[i].name;
    if (!setup->devices[i]) {
      throw InputError(fmt::format("{}: finger {} has no device to judge; give it one, or --device",
                                   setup->scene.file.string(), name));
    }
    judges.emplace_back(setup->models[i], setup->wearer ? setup->wearer : setup->models[i],
                        setup->devices[i]);
    answer.fingers.push_back(name);
  }
  SceneRun::Hooks hooks;
  hooks.on_tick = [&](std::size_t finger, const FingerChain& chain) {
    judges[finger].judge(chain.loop(), chain.device(), answer);
  };
  answer.run = run_headless(setup, run, stop, observer, std::move(hooks));
  return answer;
}

}  // namespace softfinger
