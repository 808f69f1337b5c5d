#include "softfinger/session/rendering_judge.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

/// Of a contact so much may lie off the wearer's skin.
constexpr double kBare = 0.05;

}  // namespace

RenderingJudge::RenderingJudge(std::shared_ptr<const FingerModel> model,
                               std::shared_ptr<const FingerModel> wearer,
                               const std::shared_ptr<const Device>& device,
                               const JudgedSides& sides)
    : model_(std::move(model)),
      wearer_(std::move(wearer)),
      comparison_(model_, wearer_, sides.depth),
      twin_(wearer_, device) {
  if (sides.lagged) lagged_.emplace(wearer_, device);
  if (sides.loaded && device->settings().statics) loaded_.emplace(wearer_, device);
  nodes_F_.resize(model_->mesh.nodes.size());
  servo_q_ = device->home();
}

void RenderingJudge::judge(const VirtualFinger& finger, const DeviceLoop& device,
                           Evaluation& answer) {
  const TickRecord& tick = device.record();
  const ContactSet& contact = finger.contact;
  const double friction = contact.friction_coefficient;
  const double elapsed = std::max(0.0, tick.time - time_);
  time_ = tick.time;
  EvaluatedFrame frame;
  frame.finger = static_cast<std::size_t>(tick.finger);
  frame.time = tick.time;
  frame.virtual_force = contact.normal_force;
  frame.virtual_force_sum = contact.normal_force_sum;
  frame.virtual_area = contact.contact_area;
  frame.virtual_tangential_F = contact.tangential_force_F;
  transform(finger.X_WF.inverse(), finger.nodes_W, nodes_F_);
  comparison_.take_virtual(contact, nodes_F_);
  notice_bare(tick.time);
  frame.commanded = press(twin_, tick.command.configuration, friction, elapsed, answer);
  frame.twin_force = twin_.contact().normal_force;
  frame.twin_force_sum = twin_.contact().normal_force_sum;
  frame.twin_area = twin_.contact().contact_area;
  frame.twin_tangential_F = twin_.contact().tangential_force_F;
  answer.commanded.add(frame.commanded);
  JointAngles joints;
  if (lagged_ && device.actuator().read_servo_joints(joints)) {
    // Between two commands the joints may stand for no pose of the workspace; the last one stays.
    Configuration q;
    if (device.device().forward_kinematics(joints, q)) servo_q_ = q;
    frame.lagged = press(*lagged_, servo_q_, friction, elapsed, answer);
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

void RenderingJudge::check_cover() const {
  const auto& [touched, bare] = worst_.cover;
  if (bare == 0.0) return;
  throw InputError(fmt::format(
      "{}: its skin does not cover where {} is touched: {:.1f} of {:.1f} mm2 at {:.2f} s lie off "
      "it; a wearer's group skin has to reach as far as the contact",
      wearer_->file.string(), model_->file.string(), bare / mm2, touched / mm2, worst_.time));
}

RenderingMeasures RenderingJudge::press(Twin& twin, const Configuration& q, double friction,
                                        double elapsed, Evaluation& answer) {
  if (!twin.press(q, friction, elapsed).converged) ++answer.unconverged;
  return comparison_.compare(twin.contact(), twin.positions());
}

void RenderingJudge::judge_loaded(const Configuration& q, double friction, double elapsed,
                                  EvaluatedFrame& frame, Evaluation& answer) {
  const YieldingSummary summary = loaded_->press(q, friction, elapsed);
  if (!summary.twin.converged || !summary.balanced) ++answer.unconverged;
  frame.loaded = comparison_.compare(loaded_->twin().contact(), loaded_->twin().positions());
  frame.motor_torque = summary.torque;
  frame.motors_give_way = summary.gives_way;
  if (summary.gives_way) ++answer.not_held;
  answer.loaded.add(*frame.loaded);
}

void RenderingJudge::notice_bare(double time) {
  const SkinComparison::Cover& cover = comparison_.cover();
  const bool is_bare = cover.bare > kBare * cover.touched;
  if (is_bare && cover.bare > worst_.cover.bare) worst_ = {time, cover};
}

}  // namespace softfinger
