#include "softfinger/world/world_problem.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/threads/thread_team.hpp"

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

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
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

void WorldProblem::forget() {
  has_factor_ = false;
  for (Partner& partner : partners_) partner.bodies.clear();
  soft_.forget();
}

template <typename Work>
void WorldProblem::for_each_finger(const Work& work) {
  if (team_ != nullptr) {
    team_->run(fingers_.size(), [&](std::size_t f, int) { work(*fingers_[f]); });
  } else {
    for (Partner* partner : fingers_) work(*partner);
  }
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
    const Body& body = tree_.bodies()[b];
    Vector6& wrench = wrenches_[body.object];
    scale += wrench.head<3>().squaredNorm();
    const Pose& X_WO = point.places[b].X_WO;
    const BodyMotion::Value inertia = motions_[b].evaluate(X_WO);
    const Vector3 centre = tree_.centre(b, X_WO);
    const Vector3 force = inertia.by_centre - body.inertia.mass * gravity_;
    point.energy +=
        inertia.energy + body.inertia.mass * (kLevel * gravity_.norm() - gravity_.dot(centre));
    wrench.head<3>() += force;
    wrench.tail<3>() += inertia.by_turn + (centre - X_WO.translation).cross(force);
    const double stiffness =
        motions_[b].weight() * body.inertia.mass + contact_.stiffness(body.object);
    const double rounding = kRounding / kAccuracy * stiffness * (centre.norm() + reaches_[b]);
    scale += inertia.by_centre.squaredNorm() + (body.inertia.mass * gravity_).squaredNorm() +
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

bool WorldProblem::factorise(HessianKind kind) {
  settle();
  has_factor_ = false;
  for_each_finger([&](Partner& partner) {
    FingerPotential& finger = partner.finger->potential();
    partner.bodies.clear();
    soft_.forget_factor(partner.number);
    if (!finger.factorise(kind)) return;
    for (std::size_t b = 0; b < motions_.size(); ++b) {
      if (partner.bodies.size() == partner.couplings.size()) break;
      ObstacleCoupling& coupling = partner.couplings[partner.bodies.size()];
      finger.couple(tree_.bodies()[b].object, kind, coupling);
      if (coupling.touches) partner.bodies.push_back(b);
    }
    partner.find_yielding();
  });
  has_factor_ = true;
  has_factor_ = has_factor();
  if (!has_factor_) return false;
  build_system();
  if (system_.size() == 0) return true;  // soft objects alone
  has_factor_ = Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(system_).info() == Eigen::Success;
  return has_factor_;
}

void WorldProblem::Partner::find_yielding() {
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    for (std::size_t l = 0; l < bodies.size(); ++l) {
      Matrix6& block = yielding[k * couplings.size() + l];
      for (int r = 0; r < 6; ++r) {
        for (int c = 0; c < 6; ++c) {
          block(r, c) = -dot(couplings[k].columns[static_cast<std::size_t>(r)],
                             couplings[l].responses[static_cast<std::size_t>(c)]);
        }
      }
    }
  }
}

void WorldProblem::add_pair(std::size_t a, std::size_t b, const Matrix6& block) {
  for (const BodyTree::Column& row : columns_[a].all()) {
    const Vector6 by_row = block.transpose() * row.twist;
    for (const BodyTree::Column& column : columns_[b].all()) {
      system_(row.coordinate, column.coordinate) += by_row.dot(column.twist);
    }
  }
}

void WorldProblem::build_system() {
  system_.setZero();
  for (std::size_t b = 0; b < motions_.size(); ++b) {
    add_pair(b, b, motions_[b].hessian(current_.places[b].X_WO));
  }
  for (std::size_t b = 0; b < joints_.size(); ++b) {
    if (!joints_[b]) continue;
    const int c = tree_.bodies()[b].first;
    system_(c, c) += joint_value(*joints_[b], current_.places[b].q).stiffness;
  }
  contact_.for_each_touch([&](const SolidContact::Touch& touch) {
    const int of = tree_.body_of(touch.of);
    const int on = tree_.body_of(touch.on);
    const auto arm = [&](std::size_t object) {
      Matrix36 by_pose;
      by_pose << Matrix3::Identity(), -skew(touch.at - X_WO_[object].translation);
      return by_pose;
    };
    const Matrix36 by_of = arm(touch.of);
    const Matrix36 by_on = arm(touch.on);
    const auto a = static_cast<std::size_t>(of);
    const auto b = static_cast<std::size_t>(on);
    if (of >= 0) add_pair(a, a, by_of.transpose() * touch.stiffness * by_of);
    if (on >= 0) add_pair(b, b, by_on.transpose() * touch.stiffness * by_on);
    if (of >= 0 && on >= 0) {
      const Matrix6 cross = -by_of.transpose() * touch.stiffness * by_on;
      add_pair(a, b, cross);
      add_pair(b, a, cross.transpose());
    }
  });
  for (const Partner* partner : fingers_) {
    for (std::size_t k = 0; k < partner->bodies.size(); ++k) {
      const ObstacleCoupling& coupling = partner->couplings[k];
      add_pair(partner->bodies[k], partner->bodies[k], coupling.by_obstacle);
      for (std::size_t l = 0; l < partner->bodies.size(); ++l) {
        add_pair(partner->bodies[k], partner->bodies[l],
                 partner->yielding[k * partner->couplings.size() + l]);
      }
    }
  }
}

Vector6 WorldProblem::twist_of(std::size_t body) const {
  Vector6 twist = Vector6::Zero();
  for (const BodyTree::Column& column : columns_[body].all()) {
    twist += direction_[column.coordinate] * column.twist;
  }
  return twist;
}

double WorldProblem::solve_direction(bool refined) {
  settle();
  direction_ = -current_.gradient;
  for_each_finger([](Partner& partner) { partner.finger->potential().solve_alone(); });
  for (Partner* partner : fingers_) {
    const std::span<const double> alone = partner->finger->potential().direction();
    for (std::size_t k = 0; k < partner->bodies.size(); ++k) {
      Vector6 load;
      for (int c = 0; c < 6; ++c) {
        load[c] = dot(partner->couplings[k].columns[static_cast<std::size_t>(c)], alone);
      }
      for (const BodyTree::Column& column : columns_[partner->bodies[k]].all()) {
        direction_[column.coordinate] -= column.twist.dot(load);
      }
    }
  }
  // Contact between objects changes within a step; their system is small enough to be built anew.
  build_system();
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(system_);
  if (factor.info() != Eigen::Success) return 0.0;
  factor.solveInPlace(direction_);
  for_each_finger([&](Partner& partner) {
    for (std::size_t k = 0; k < partner.bodies.size(); ++k) {
      partner.finger->potential().yield_to(partner.couplings[k], twist_of(partner.bodies[k]));
    }
  });
  if (soft_.any()) bend_to_soft_contact(factor, refined);
  if (refined) correct_directions();
  double slope = direction_.dot(current_.gradient);
  for (const Partner* partner : fingers_) slope += partner->finger->potential().slope();
  return slope;
}

void WorldProblem::bend_to_soft_contact(const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>& factor,
                                        bool refined) {
  if (!soft_.find_pairs(team_)) return;
  const auto rows = static_cast<Eigen::Index>(3 * soft_.size());
  const Eigen::Index freedoms = direction_.size();
  const bool touches = std::ranges::any_of(
      fingers_, [](const Partner* partner) { return !partner->bodies.empty(); });
  auto pulled = pulled_.topLeftCorner(rows, freedoms);
  auto yielding = yielding_.topLeftCorner(freedoms, rows);
  if (touches) {
    pulled.setZero();
    for (const Partner* partner : fingers_) {
      for (std::size_t k = 0; k < partner->bodies.size(); ++k) {
        for (std::size_t p = 0; p < soft_.size(); ++p) {
          Matrix36 by_pose;
          for (std::size_t c = 0; c < 6; ++c) {
            by_pose.col(static_cast<Eigen::Index>(c)) =
                soft_.way(p, partner->number, partner->couplings[k].responses[c]);
          }
          for (const BodyTree::Column& column : columns_[partner->bodies[k]].all()) {
            pulled.block<3, 1>(static_cast<Eigen::Index>(3 * p), column.coordinate) +=
                by_pose * column.twist;
          }
        }
      }
    }
    yielding = pulled.transpose();
    for (Eigen::Index c = 0; c < rows; ++c) {
      Eigen::Ref<Eigen::VectorXd> column = yielding.col(c);
      factor.solveInPlace(column);
    }
    soft_.compliance() += pulled.lazyProduct(yielding);
  }
  const std::span<const double> forces = soft_.balance(refined);
  for_each_finger([&](Partner& partner) { soft_.apply(partner.number); });
  if (!touches) return;
  recoil_.noalias() = yielding * Eigen::Map<const Eigen::VectorXd>(forces.data(), rows);
  direction_ += recoil_;
  recoil_.swap(direction_);  // for twist_of()
  for_each_finger([&](Partner& partner) {
    for (std::size_t k = 0; k < partner.bodies.size(); ++k) {
      partner.finger->potential().yield_to(partner.couplings[k], twist_of(partner.bodies[k]));
    }
  });
  recoil_.swap(direction_);
}

void WorldProblem::correct_directions() {
  if (fingers_.empty()) return;
  for_each_finger([](Partner& partner) { partner.finger->potential().start_correction(); });
  tree_.advance(current_.places, {direction_.data(), static_cast<std::size_t>(direction_.size())},
                1.0, time_, expected_);
  double way = 0.0;
  for (std::size_t b = 0; b < expected_.size(); ++b) {
    const Vector6 twist = twist_of(b);
    way = std::max(way, twist.head<3>().norm() + twist.tail<3>().norm() * reaches_[b]);
  }
  show(expected_);
  for_each_finger([&](Partner& partner) {
    std::fill(partner.carried.begin(), partner.carried.end(), Vector3::Zero());
    FingerPotential& finger = partner.finger->potential();
    const std::size_t points = finger.contact_positions().size();
    for (std::size_t k = 0; k < partner.bodies.size(); ++k) {
      const Vector6 twist = twist_of(partner.bodies[k]);
      for (std::size_t i = 0; i < points; ++i) {
        partner.carried[i] += partner.couplings[k].by_point[i] * twist;
      }
    }
    finger.correct_direction({partner.carried.data(), points}, way);
  });
  show(current_.places);
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
