#include "softfinger/world/world_problem.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/finger/finger_potential.hpp"

namespace softfinger {
namespace {

/// Bodies that one finger may touch at once and whose motion its directions know of; with more,
/// minimisation takes longer.
constexpr std::size_t kMostTouched = 8;
/// Below this force, N, the residual is absolute.
constexpr double kForceFloor = 1e-6;
/// Positions are known to this part, and forces to as much of stiffness times distance. It counts
/// as a force so large that no residual below kAccuracy is asked for.
constexpr double kRounding = 16.0 * std::numeric_limits<double>::epsilon();
constexpr double kAccuracy = 1e-11;
/// Heights are measured from this far below, m, so that the rounding of an energy, which the line
/// search allows for as a part of it, does not vanish where the energy does.
constexpr double kLevel = 1.0;
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

WorldProblem::WorldProblem(const BodyTree& tree, std::span<BodyMotion> motions,
                           SolidContact& contact, const Vector3& gravity, double time_step,
                           ThreadTeam* team)
    : tree_(tree),
      motions_(motions),
      contact_(contact),
      gravity_(gravity),
      time_step_(time_step),
      team_(team),
      columns_(tree.bodies().size()),
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
  const auto freedoms = static_cast<Eigen::Index>(tree.freedoms());
  for (Point* point : {&current_, &trial_}) {
    point->places = tree.start();
    point->gradient.setZero(freedoms);
  }
  expected_ = current_.places;
  system_.setZero(freedoms, freedoms);
  direction_.setZero(freedoms);
  recoil_ = direction_;
}

void WorldProblem::reserve(FingerSimulation& finger, int object) {
  Partner& partner = partners_.emplace_back();
  partner.finger = &finger;
  partner.number = partners_.size() - 1;
  soft_.add(finger, object);
  taking_part_.push_back(0);
  if (object >= 0 && pulled_.size() == 0) {
    pulled_.setZero(static_cast<Eigen::Index>(3 * SoftContact::kMostPairs), direction_.size());
    yielding_.setZero(direction_.size(), static_cast<Eigen::Index>(3 * SoftContact::kMostPairs));
  }
  const ObstacleCoupling none = finger.potential().make_coupling();
  partner.couplings.assign(std::min(kMostTouched, tree_.bodies().size()), none);
  partner.bodies.reserve(partner.couplings.size());
  partner.yielding.resize(partner.couplings.size() * partner.couplings.size());
  partner.carried.assign(none.by_point.size(), Vector3::Zero());
  fingers_.reserve(partners_.size());
}

void WorldProblem::put(std::size_t b, const Pose& X_WT, bool present) {
  pulls_[b]->pull.put(X_WT);
  pulls_[b]->present = present;
}

void WorldProblem::hold(std::size_t b, const Pose* X_WT) {
  Pulled& held = *holds_[b];
  const bool present = X_WT != nullptr;
  if (present != held.present) has_factor_ = false;
  if (present && !held.present) held.pull.put(motions_[b].place().X_WO);
  if (present) held.pull.follow(*X_WT);
  held.present = present;
}

void WorldProblem::forget() {
  has_factor_ = false;
  for (Partner& partner : partners_) partner.bodies.clear();
  soft_.forget();
}

void WorldProblem::begin(double time, std::span<Pose> X_WO, std::span<const BodyPlace> places,
                         std::span<FingerSimulation* const> fingers) {
  time_ = time;
  X_WO_ = X_WO;
  wrenches_.resize(X_WO.size());
  fingers_.clear();
  for (Partner& partner : partners_) {
    const bool takes_part = std::ranges::find(fingers, partner.finger) != fingers.end();
    if (takes_part != partner.taking_part) {
      partner.bodies.clear();
      has_factor_ = false;
    }
    partner.taking_part = takes_part;
    taking_part_[partner.number] = takes_part ? 1 : 0;
    if (takes_part) fingers_.push_back(&partner);
  }
  const bool touched = soft_.any();
  soft_.begin(taking_part_);
  for (std::size_t b = 0; b < joints_.size(); ++b) {
    if (joints_[b]) joints_[b]->old_q = motions_[b].place().q;
    if (pulls_[b]) pulls_[b]->pull.begin(time_step_, motions_[b].place().X_WO);
    if (is_held(b)) holds_[b]->pull.begin(time_step_, motions_[b].place().X_WO);
  }
  std::copy(places.begin(), places.end(), current_.places.begin());
  show(current_.places);
  // They have begun without knowing of each other, or of who is gone.
  if (soft_.any() || touched) evaluate_fingers(At::kCurrent);
  evaluate(current_);
  cache_is_current_ = true;
}

void WorldProblem::evaluate_fingers(At at) {
  soft_.follow(at);
  for_each_finger([&](Partner& partner) { partner.finger->potential().meet(at); });
  soft_.hand_over();
  for_each_finger([&](Partner& partner) { partner.finger->potential().complete(at); });
}

void WorldProblem::end() {
  for (auto* const all : {&pulls_, &holds_}) {
    for (std::optional<Pulled>& pulled : *all) {
      if (pulled) pulled->pull.end();
    }
  }
  for (std::size_t b = 0; b < joints_.size(); ++b) {
    if (!joints_[b]) continue;
    JointForces& joint = *joints_[b];
    joint.anchor = joint.law.anchor_after(current_.places[b].q, joint.anchor);
  }
}

void WorldProblem::reset() {
  for (std::optional<JointForces>& joint : joints_) {
    if (joint) joint->anchor = 0.0;
  }
  const std::vector<BodyPlace> starts = tree_.start();
  for (std::size_t b = 0; b < pulls_.size(); ++b) {
    if (pulls_[b]) put(b, starts[b].X_WO, true);
    if (holds_[b]) holds_[b]->present = false;
  }
  forget();
}

LawValue WorldProblem::joint_value(const JointForces& joint, double q) const {
  LawValue sum = joint.law.evaluate(q);
  const LawValue friction = joint.law.friction(q, joint.anchor);
  const double damping = joint.damping / time_step_;
  const double moved = q - joint.old_q;
  sum.energy += friction.energy + 0.5 * damping * moved * moved;
  sum.force += friction.force + damping * moved;
  sum.stiffness += friction.stiffness + damping;
  return sum;
}

void WorldProblem::show(std::span<const BodyPlace> places) {
  for (std::size_t b = 0; b < places.size(); ++b) {
    const std::size_t object = tree_.bodies()[b].object;
    X_WO_[object] = places[b].X_WO;
    for (Partner* partner : fingers_) partner->finger->move_object(object, places[b].X_WO);
  }
}

void WorldProblem::evaluate(Point& point) {
  std::fill(wrenches_.begin(), wrenches_.end(), Vector6::Zero());
  point.energy = contact_.evaluate(X_WO_, wrenches_);
  point.residual = 0.0;
  for (Partner* partner : fingers_) {
    const FingerPotential& finger = partner->finger->potential();
    point.energy += &point == &trial_ ? finger.trial_energy() : finger.energy();
    point.residual =
        std::max(point.residual, &point == &trial_ ? finger.trial_residual() : finger.residual());
    for (const Body& body : tree_.bodies()) {
      const ContactPotential::Wrench& wrench = finger.contact().wrench(body.object);
      wrenches_[body.object].head<3>() += wrench.by_translation;
      wrenches_[body.object].tail<3>() += wrench.by_rotation;
    }
  }
  add_bodies(point);
}

void WorldProblem::add_bodies(Point& point) {
  tree_.columns(point.places, time_, columns_);
  point.gradient.setZero();
  double scale = contact_.force_norm() * contact_.force_norm();
  for (std::size_t b = 0; b < motions_.size(); ++b) {
    if (is_nowhere(b)) continue;
    const Body& body = tree_.bodies()[b];
    Vector6& wrench = wrenches_[body.object];
    scale += wrench.head<3>().squaredNorm();
    const Pose& X_WO = point.places[b].X_WO;
    const BodyMotion::Value inertia = motions_[b].evaluate(X_WO);
    const Vector3 centre = tree_.centre(b, X_WO);
    // A hand bears itself.
    const Vector3 gravity = pulls_[b] ? Vector3(Vector3::Zero()) : gravity_;
    const Vector3 force = inertia.by_centre - body.inertia.mass * gravity;
    point.energy +=
        inertia.energy + body.inertia.mass * (kLevel * gravity.norm() - gravity.dot(centre));
    wrench.head<3>() += force;
    wrench.tail<3>() += inertia.by_turn + (centre - X_WO.translation).cross(force);
    if (const BodyPull* const by = pull_on(b)) {
      const BodyPull::Value pull = by->evaluate(X_WO);
      point.energy += pull.energy;
      wrench.head<3>() += pull.by_origin;
      wrench.tail<3>() += pull.by_turn;
      scale += pull.by_origin.squaredNorm();
    }
    const double stiffness =
        motions_[b].weight() * body.inertia.mass + contact_.stiffness(body.object);
    const double rounding = kRounding / kAccuracy * stiffness * (centre.norm() + reaches_[b]);
    scale += inertia.by_centre.squaredNorm() + (body.inertia.mass * gravity).squaredNorm() +
             rounding * rounding;
    for (const BodyTree::Column& column : columns_[b].all()) {
      point.gradient[column.coordinate] += column.twist.dot(wrench);
    }
  }
  for (std::size_t b = 0; b < joints_.size(); ++b) {
    if (!joints_[b]) continue;
    const LawValue value = joint_value(*joints_[b], point.places[b].q);
    const int c = tree_.bodies()[b].first;
    point.energy += value.energy;
    point.gradient[c] += value.force;
    const double force = value.force / lengths_[static_cast<std::size_t>(c)];
    scale += force * force;
  }
  double squared = 0.0;
  for (Eigen::Index c = 0; c < point.gradient.size(); ++c) {
    const double force = point.gradient[c] / lengths_[static_cast<std::size_t>(c)];
    squared += force * force;
  }
  point.residual =
      std::max(point.residual, std::sqrt(squared) / std::max(std::sqrt(scale), kForceFloor));
}

bool WorldProblem::has_factor() const {
  return has_factor_ && std::ranges::all_of(fingers_, [](const Partner* partner) {
           return partner->finger->potential().has_factor();
         });
}

void WorldProblem::evaluate_trial(double t) {
  tree_.advance(current_.places, {direction_.data(), static_cast<std::size_t>(direction_.size())},
                t, time_, trial_.places);
  show(trial_.places);
  if (soft_.any()) {
    for_each_finger([&](Partner& partner) { partner.finger->potential().put_trial(t); });
    evaluate_fingers(At::kTrial);
  } else {
    for_each_finger([&](Partner& partner) { partner.finger->potential().evaluate_trial(t); });
  }
  evaluate(trial_);
  cache_is_current_ = false;
}

void WorldProblem::accept_trial() {
  std::swap(current_, trial_);
  for (Partner* partner : fingers_) partner->finger->potential().accept_trial();
  cache_is_current_ = true;
}

void WorldProblem::settle() {
  if (cache_is_current_) return;
  show(current_.places);
  if (soft_.any()) {
    evaluate_fingers(At::kCurrent);
  } else {
    for_each_finger([](Partner& partner) { partner.finger->potential().settle(); });
  }
  evaluate(current_);
  cache_is_current_ = true;
}

void WorldProblem::renew() {
  show(current_.places);
  if (soft_.any()) {
    evaluate_fingers(At::kCurrent);
  } else {
    for_each_finger([](Partner& partner) { partner.finger->potential().renew(); });
  }
  evaluate(current_);
  cache_is_current_ = true;
}

bool WorldProblem::is_tangled() const {
  return std::ranges::any_of(
      fingers_, [](const Partner* partner) { return partner->finger->potential().is_tangled(); });
}

void WorldProblem::limit_strain(bool limited) {
  show(current_.places);
  for_each_finger([&](Partner& p) { p.finger->potential().limit_strain(limited); });
  if (soft_.any()) evaluate_fingers(At::kCurrent);
  evaluate(current_);
  cache_is_current_ = true;
}

bool WorldProblem::is_in_cone() const {
  return contact_.is_in_cone() && std::ranges::all_of(fingers_, [](const Partner* partner) {
           return partner->finger->potential().is_in_cone();
         });
}

void WorldProblem::update_limits(bool only_lower) {
  for (Partner* partner : fingers_) partner->finger->potential().update_limits(only_lower);
  contact_.update_limits(only_lower);
}

}  // namespace softfinger
