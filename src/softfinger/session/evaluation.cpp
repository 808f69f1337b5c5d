#include "softfinger/session/evaluation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/loop/finger_chain.hpp"
#include "softfinger/session/scene_load.hpp"
#include "softfinger/twin/skin_comparison.hpp"
#include "softfinger/twin/twin.hpp"
#include "softfinger/twin/yielding_twin.hpp"

namespace softfinger {
namespace {

/// Of a contact so much may lie off the wearer's skin.
constexpr double kBare = 0.05;

/// What judges one finger's device.
class Judge {
 public:
  Judge(const std::shared_ptr<const FingerModel>& model,
        const std::shared_ptr<const FingerModel>& wearer,
        const std::shared_ptr<const Device>& device)
      : comparison_(model, wearer, SkinComparison::Depth::kTissue),
        twin_(wearer, device),
        lagged_(wearer, device) {
    nodes_F_.resize(model->mesh.nodes.size());
    servo_q_ = device->home();
    if (device->settings().statics) loaded_.emplace(wearer, device);
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
    transform(loop.simulation().bone_pose().inverse(), loop.simulation().positions(), nodes_F_);
    comparison_.take_virtual(loop.contact(), nodes_F_);
    notice_bare(tick.time);
    frame.commanded = press(twin_, tick.command.configuration, friction, elapsed, answer);
    frame.twin_force = twin_.contact().normal_force;
    frame.twin_force_sum = twin_.contact().normal_force_sum;
    frame.twin_tangential_F = twin_.contact().tangential_force_F;
    answer.commanded.add(frame.commanded);
    JointAngles joints;
    if (device.actuator().read_servo_joints(joints)) {
      // Between two commands the joints may stand for no pose of the workspace; the last one stays.
      Configuration q;
      if (device.device().forward_kinematics(joints, q)) servo_q_ = q;
      frame.lagged = press(lagged_, servo_q_, friction, elapsed, answer);
      answer.lagged.add(*frame.lagged);
    } else {
      answer.has_lagged = false;
    }
    if (loaded_) {
      judge_loaded(tick.command.configuration, friction, elapsed, frame, answer);
    } else {
      answer.has_loaded = false;
    }
    answer.frames.push_back(frame);
  }

  /// Throws where the virtual contact was where the wearer has no skin.
  void check_cover(const FingerModel& model, const FingerModel& wearer) const {
    const auto& [touched, bare] = worst_.cover;
    if (bare == 0.0) return;
    throw InputError(fmt::format(
        "{}: its skin does not cover where {} is touched: {:.1f} of {:.1f} mm2 at {:.2f} s lie off "
        "it; a wearer's group skin has to reach as far as the contact",
        wearer.file.string(), model.file.string(), bare / mm2, touched / mm2, worst_.time));
  }

 private:
  RenderingMeasures press(Twin& twin, const Configuration& q, double friction, double elapsed,
                          Evaluation& answer) {
    if (!twin.press(q, friction, elapsed).converged) ++answer.unconverged;
    return comparison_.compare(twin.contact(), twin.positions());
  }
  void judge_loaded(const Configuration& q, double friction, double elapsed, EvaluatedFrame& frame,
                    Evaluation& answer) {
    const YieldingSummary summary = loaded_->press(q, friction, elapsed);
    if (!summary.twin.converged || !summary.balanced) ++answer.unconverged;
    frame.loaded = comparison_.compare(loaded_->twin().contact(), loaded_->twin().positions());
    frame.motor_torque = summary.torque;
    frame.motors_give_way = summary.gives_way;
    if (summary.gives_way) ++answer.not_held;
    answer.loaded.add(*frame.loaded);
  }
  void notice_bare(double time) {
    const SkinComparison::Cover& cover = comparison_.cover();
    const bool is_bare = cover.bare > kBare * cover.touched;
    if (is_bare && cover.bare > worst_.cover.bare) worst_ = {time, cover};
  }

  SkinComparison comparison_;
  Twin twin_, lagged_;
  std::optional<YieldingTwin> loaded_;
  std::vector<Vector3> nodes_F_;
  Configuration servo_q_;
  double time_ = 0.0;
  struct {
    double time = 0.0;  ///< s
    SkinComparison::Cover cover;
  } worst_;  ///< of the frames with too much contact off the wearer's skin
};

}  // namespace

Evaluation evaluate(const EvaluationOptions& options, const std::atomic<bool>& stop,
                    const RunObserver& observer) {
  RunOptions run = options.run;
  run.as_fast_as_possible = true;
  run.actuator.port = "emulator";
  const std::shared_ptr<const RunSetup> setup = load_unless_stopped(run, stop);
  if (!setup) throw OperationError("evaluate: ended while the scene was loading");
  if (setup->models.empty()) {
    throw InputError(
        fmt::format("{}: has no finger to judge a device by", setup->scene.file.string()));
  }
  std::vector<Judge> judges;
  Evaluation answer;
  answer.has_lagged = true;
  answer.has_loaded = true;
  for (std::size_t i = 0; i < setup->models.size(); ++i) {
    const std::string& name = setup->scene.fingers[i].name;
    if (!setup->devices[i]) {
      throw InputError(fmt::format("{}: finger {} has no device to judge; give it one, or --device",
                                   setup->scene.file.string(), name));
    }
    if (run.objective != nullptr) {
      const std::string why = why_not(*run.objective, *setup->devices[i]);
      if (!why.empty()) {
        throw InputError(
            fmt::format("--objective: {}: {}", setup->scene.fingers[i].device->string(), why));
      }
    }
    judges.emplace_back(setup->models[i], setup->wearer ? setup->wearer : setup->models[i],
                        setup->devices[i]);
    answer.fingers.push_back(name);
    answer.linear_motors.push_back(setup->devices[i]->joint_limits().linear);
  }
  SceneRun::Hooks hooks;
  hooks.on_tick = [&](std::size_t finger, const FingerChain& chain) {
    judges[finger].judge(chain.loop(), chain.device(), answer);
  };
  answer.run = run_headless(setup, run, stop, observer, std::move(hooks));
  for (std::size_t i = 0; setup->wearer && i < judges.size(); ++i) {
    judges[i].check_cover(*setup->models[i], *setup->wearer);
  }
  return answer;
}

}  // namespace softfinger
