#include "softfinger/world/body_forces.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <string>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

/// Of a joint's limits, times the inertia of a step.
constexpr double kLimitStiffness = 10.0;

/// Natural frequency, rad/s, of what is held, damped critically: its weight lets it down by 2.5 mm.
constexpr double kHoldRate = 2.0 * std::numbers::pi * 10.0;
/// A hold pulls with so many times the weight, and this much besides, N.
constexpr double kHoldWeights = 2.0;
constexpr double kHoldForce = 5.0;

/// What pulls a body that a person holds; its surface reaches this far from O's origin, m.
Following hold_of(const BodyInertia& inertia, double gravity, double reach) {
  const double moment =
      inertia.second_O.trace() + inertia.mass * inertia.centre_O.squaredNorm();  // at least
  const double force = kHoldForce + kHoldWeights * inertia.mass * gravity;
  return {.stiffness = inertia.mass * kHoldRate * kHoldRate,
          .damping = 2.0 * inertia.mass * kHoldRate,
          .rotation_stiffness = moment * kHoldRate * kHoldRate,
          .rotation_damping = 2.0 * moment * kHoldRate,
          .force_limit = force,
          .torque_limit = reach * force};
}

std::string too_steep(const Body& body, double times) {
  const bool curve = body.joint->curve.has_value();
  return fmt::format("its {} falls too steeply for this mass and simulation_Hz; {:.3g} g would do",
                     curve ? "curve" : "detents", 1.05 * times * body.inertia.mass * 1e3);
}

}  // namespace

BodyForces::BodyForces(const BodyTree& tree, const Vector3& gravity, double time_step)
    : tree_(tree),
      gravity_(gravity),
      time_step_(time_step),
      lengths_(static_cast<std::size_t>(tree.freedoms()), 1.0) {
  for (const Body& body : tree.bodies()) {
    double squared = body.inertia.second_O.trace() / body.inertia.mass;  // radius of gyration
    if (body.joint) squared += (body.inertia.centre_O - body.joint->point_O).squaredNorm();
    const double reach = std::sqrt(squared);
    reaches_.push_back(2.0 * reach + body.inertia.centre_O.norm());
    const bool turns_only = body.joint && body.joint->kind != JointKind::kSlider;
    for (int c = turns_only ? 0 : 3; c < body.freedoms; ++c) {
      lengths_[static_cast<std::size_t>(body.first + c)] = reach;
    }
  }
  for (const Body& body : tree.bodies()) {
    joints_.emplace_back();
    if (!body.joint || body.freedoms != 1) continue;
    const double per_step = inertia_about(*body.joint, body.inertia) / (time_step * time_step);
    const JointLaw law(*body.joint, kLimitStiffness * per_step);
    // Else a step would have two minima.
    if (!(per_step > -law.least_stiffness())) {
      throw InputError(fmt::format("object '{}': {}", tree.name(body.object),
                                   too_steep(body, -law.least_stiffness() / per_step)));
    }
    joints_.back().emplace(JointForces{.law = law, .damping = body.joint->damping});
  }
  const std::vector<BodyPlace> starts = tree.start();
  for (std::size_t b = 0; b < tree.bodies().size(); ++b) {
    pulls_.emplace_back();
    holds_.emplace_back();
    if (const auto& following = tree.following(b)) {
      pulls_.back().emplace(Pulled{.pull = BodyPull(*following, starts[b].X_WO)});
    } else {
      const Following hold = hold_of(tree.bodies()[b].inertia, gravity.norm(), reaches_[b]);
      holds_.back().emplace(Pulled{.pull = BodyPull(hold, starts[b].X_WO), .present = false});
    }
  }
}

LawValue BodyForces::joint(std::size_t b, double q) const {
  const JointForces& joint = *joints_[b];
  LawValue sum = joint.law.evaluate(q);
  const LawValue friction = joint.law.friction(q, joint.anchor);
  const double damping = joint.damping / time_step_;
  const double moved = q - joint.old_q;
  sum.energy += friction.energy + 0.5 * damping * moved * moved;
  sum.force += friction.force + damping * moved;
  sum.stiffness += friction.stiffness + damping;
  return sum;
}

void BodyForces::put(std::size_t b, const Pose& X_WT, bool present) {
  pulls_[b]->pull.put(X_WT);
  pulls_[b]->present = present;
}

void BodyForces::hold(std::size_t b, const Pose& X_WO, const Pose* X_WT) {
  Pulled& held = *holds_[b];
  const bool present = X_WT != nullptr;
  if (present && !held.present) held.pull.put(X_WO);
  if (present) held.pull.follow(*X_WT);
  held.present = present;
}

const BodyPull* BodyForces::pull_on(std::size_t b) const {
  if (pulls_[b]) return &pulls_[b]->pull;
  return is_held(b) ? &holds_[b]->pull : nullptr;
}

void BodyForces::begin(std::size_t b, const BodyPlace& place) {
  if (joints_[b]) joints_[b]->old_q = place.q;
  if (pulls_[b]) pulls_[b]->pull.begin(time_step_, place.X_WO);
  if (is_held(b)) holds_[b]->pull.begin(time_step_, place.X_WO);
}

void BodyForces::end(std::size_t b, const BodyPlace& place) {
  if (pulls_[b]) pulls_[b]->pull.end();
  if (holds_[b]) holds_[b]->pull.end();
  if (joints_[b]) joints_[b]->anchor = joints_[b]->law.anchor_after(place.q, joints_[b]->anchor);
}

void BodyForces::reset() {
  const std::vector<BodyPlace> starts = tree_.start();
  for (std::size_t b = 0; b < pulls_.size(); ++b) {
    if (joints_[b]) joints_[b]->anchor = 0.0;
    if (pulls_[b]) put(b, starts[b].X_WO, true);
    if (holds_[b]) holds_[b]->present = false;
  }
}

}  // namespace softfinger
