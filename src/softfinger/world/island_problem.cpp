#include "softfinger/world/island_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace softfinger {
namespace {

/// Below this force, N, the residual is absolute.
constexpr double kForceFloor = 1e-6;
/// Positions are known to this part, and forces to as much of stiffness times distance. It counts
/// as a force so large that no residual below kAccuracy is asked for.
constexpr double kRounding = 16.0 * std::numeric_limits<double>::epsilon();
constexpr double kAccuracy = 1e-11;
/// Heights are measured from this far below, m, so that the rounding of an energy, which the line
/// search allows for as a part of it, does not vanish where the energy does.
constexpr double kLevel = 1.0;

}  // namespace

IslandProblem::IslandProblem(const WorldParts& parts)
    : parts_(parts), wrenches_(parts.X_WO.size()), columns_(parts.tree.bodies().size()) {
  const auto freedoms = static_cast<std::size_t>(parts.tree.freedoms());
  for (Point* point : {&current_, &trial_}) {
    point->places = parts.tree.start();
    point->gradient.assign(freedoms, 0.0);
  }
  expected_ = current_.places;
  direction_.assign(freedoms, 0.0);
  recoil_ = direction_;
  block_of_coordinate_.assign(freedoms, -1);
  first_of_coordinate_.assign(freedoms, 0);
  system_.reserve(columns_.size());
  freedoms_.reserve(columns_.size());
  side_.reserve(6 * columns_.size());
}

void IslandProblem::reserve(bool soft) {
  taking_part_.assign(parts_.partners.size(), 0);
  if (!soft || pulled_.size() > 0) return;
  const auto freedoms = static_cast<Eigen::Index>(direction_.size());
  pulled_.setZero(freedoms, static_cast<Eigen::Index>(3 * SoftContact::kMostPairs));
  yielding_.setZero(freedoms, static_cast<Eigen::Index>(3 * SoftContact::kMostPairs));
}

void IslandProblem::begin(const Island& island, double time, ThreadTeam* team) {
  time_ = time;
  team_ = team;
  number_ = island.number;
  bodies_ = island.bodies;
  partners_ = island.partners;
  is_soft_ = island.is_soft;
  evaluations_ = 0;
  const auto among = [&](std::size_t b) { return std::ranges::binary_search(bodies_, b); };
  bool met_soft = false;
  for (Partner* partner : partners_) {
    if (!std::ranges::all_of(partner->bodies, among)) partner->forget();
    met_soft = met_soft || partner->met_soft;
  }
  if (is_soft_) {
    std::ranges::fill(taking_part_, std::uint8_t{0});
    for (const Partner* partner : partners_) taking_part_[partner->number] = 1;
    parts_.soft.begin(taking_part_);
  }
  for (Partner* partner : partners_) partner->met_soft = pairs_may_meet();
  for (const std::size_t b : bodies_) {
    parts_.forces.begin(b, parts_.motions[b].place());
    current_.places[b] = parts_.places[b];
  }
  arrange_system();
  show(current_.places);
  // They have begun without knowing of each other, or of who is gone.
  if (pairs_may_meet() || met_soft) evaluate_fingers(At::kCurrent);
  evaluate(current_);
  cache_is_current_ = true;
}

void IslandProblem::end() {
  for (const std::size_t b : bodies_) {
    parts_.places[b] = current_.places[b];
    parts_.forces.end(b, current_.places[b]);
  }
}

void IslandProblem::evaluate_fingers(At at) {
  if (is_soft_) parts_.soft.follow(at);
  for_each_partner([&](Partner& partner) { partner.finger->potential().meet(at); });
  if (is_soft_) parts_.soft.hand_over();
  for_each_partner([&](Partner& partner) { partner.finger->potential().complete(at); });
}

void IslandProblem::show(std::span<const BodyPlace> places) {
  for (const std::size_t b : bodies_) {
    const std::size_t object = parts_.tree.bodies()[b].object;
    parts_.X_WO[object] = places[b].X_WO;
    for (const Partner* partner : partners_) partner->finger->move_object(object, places[b].X_WO);
  }
}

void IslandProblem::evaluate(Point& point) {
  ++evaluations_;
  system_is_current_ = false;
  for (const std::size_t b : bodies_) wrenches_[parts_.tree.bodies()[b].object].setZero();
  const SolidContact::Sum contact = parts_.contact.evaluate(number_, parts_.X_WO, wrenches_);
  point.energy = contact.energy;
  point.residual = 0.0;
  for (const Partner* partner : partners_) {
    const FingerPotential& finger = partner->finger->potential();
    point.energy += &point == &trial_ ? finger.trial_energy() : finger.energy();
    point.residual =
        std::max(point.residual, &point == &trial_ ? finger.trial_residual() : finger.residual());
    for (const std::size_t b : bodies_) {
      const std::size_t object = parts_.tree.bodies()[b].object;
      const ContactPotential::Wrench& wrench = finger.contact().wrench(object);
      wrenches_[object].head<3>() += wrench.by_translation;
      wrenches_[object].tail<3>() += wrench.by_rotation;
    }
  }
  add_bodies(point, contact.squared_force);
}

void IslandProblem::add_bodies(Point& point, double squared_contact_force) {
  parts_.tree.columns(bodies_, point.places, time_, columns_);
  double scale = squared_contact_force;
  for (const std::size_t b : bodies_) {
    const Body& body = parts_.tree.bodies()[b];
    std::fill_n(point.gradient.begin() + body.first, body.freedoms, 0.0);
    Vector6& wrench = wrenches_[body.object];
    scale += wrench.head<3>().squaredNorm();
    const Pose& X_WO = point.places[b].X_WO;
    const BodyMotion::Value inertia = parts_.motions[b].evaluate(X_WO);
    const Vector3 centre = parts_.tree.centre(b, X_WO);
    const Vector3 gravity = parts_.forces.gravity(b);
    const Vector3 force = inertia.by_centre - body.inertia.mass * gravity;
    point.energy +=
        inertia.energy + body.inertia.mass * (kLevel * gravity.norm() - gravity.dot(centre));
    wrench.head<3>() += force;
    wrench.tail<3>() += inertia.by_turn + (centre - X_WO.translation).cross(force);
    if (const BodyPull* const by = parts_.forces.pull_on(b)) {
      const BodyPull::Value pull = by->evaluate(X_WO);
      point.energy += pull.energy;
      wrench.head<3>() += pull.by_origin;
      wrench.tail<3>() += pull.by_turn;
      scale += pull.by_origin.squaredNorm();
    }
    const double stiffness =
        parts_.motions[b].weight() * body.inertia.mass + parts_.contact.stiffness(body.object);
    const double rounding =
        kRounding / kAccuracy * stiffness * (centre.norm() + parts_.forces.reach(b));
    scale += inertia.by_centre.squaredNorm() + (body.inertia.mass * gravity).squaredNorm() +
             rounding * rounding;
    for (const BodyTree::Column& column : columns_[b].all()) {
      point.gradient[static_cast<std::size_t>(column.coordinate)] += column.twist.dot(wrench);
    }
  }
  double squared = 0.0;
  for (const std::size_t b : bodies_) {
    const Body& body = parts_.tree.bodies()[b];
    if (parts_.forces.law(b) != nullptr) {
      const LawValue value = parts_.forces.joint(b, point.places[b].q);
      point.energy += value.energy;
      point.gradient[static_cast<std::size_t>(body.first)] += value.force;
      const double force = value.force / parts_.forces.length(body.first);
      scale += force * force;
    }
    for (int c = body.first; c < body.first + body.freedoms; ++c) {
      const double force = point.gradient[static_cast<std::size_t>(c)] / parts_.forces.length(c);
      squared += force * force;
    }
  }
  point.residual =
      std::max(point.residual, std::sqrt(squared) / std::max(std::sqrt(scale), kForceFloor));
}

bool IslandProblem::has_factor() const {
  return std::ranges::all_of(partners_, [](const Partner* partner) {
    return partner->coupled && partner->finger->potential().has_factor();
  });
}

void IslandProblem::evaluate_trial(double t) {
  parts_.tree.advance(bodies_, current_.places, direction_, t, time_, trial_.places);
  show(trial_.places);
  if (pairs_may_meet()) {
    for_each_partner([&](Partner& partner) { partner.finger->potential().put_trial(t); });
    evaluate_fingers(At::kTrial);
  } else {
    for_each_partner([&](Partner& partner) { partner.finger->potential().evaluate_trial(t); });
  }
  evaluate(trial_);
  cache_is_current_ = false;
}

void IslandProblem::accept_trial() {
  std::swap(current_, trial_);
  for (Partner* partner : partners_) partner->finger->potential().accept_trial();
  cache_is_current_ = true;
}

void IslandProblem::settle() {
  if (cache_is_current_) return;
  show(current_.places);
  if (pairs_may_meet()) {
    evaluate_fingers(At::kCurrent);
  } else {
    for_each_partner([](Partner& partner) { partner.finger->potential().settle(); });
  }
  evaluate(current_);
  cache_is_current_ = true;
}

void IslandProblem::renew() {
  show(current_.places);
  if (pairs_may_meet()) {
    evaluate_fingers(At::kCurrent);
  } else {
    for_each_partner([](Partner& partner) { partner.finger->potential().renew(); });
  }
  evaluate(current_);
  cache_is_current_ = true;
}

bool IslandProblem::is_tangled() const {
  return std::ranges::any_of(
      partners_, [](const Partner* partner) { return partner->finger->potential().is_tangled(); });
}

void IslandProblem::limit_strain(bool limited) {
  show(current_.places);
  for_each_partner([&](Partner& p) { p.finger->potential().limit_strain(limited); });
  if (pairs_may_meet()) evaluate_fingers(At::kCurrent);
  evaluate(current_);
  cache_is_current_ = true;
}

bool IslandProblem::is_in_cone() const {
  return parts_.contact.is_in_cone(number_) &&
         std::ranges::all_of(partners_, [](const Partner* partner) {
           return partner->finger->potential().is_in_cone();
         });
}

double IslandProblem::beyond_cone() const {
  double sum = parts_.contact.beyond_cone(number_);
  for (const Partner* partner : partners_) {
    sum += partner->finger->potential().contact().beyond_cone();
  }
  return sum;
}

void IslandProblem::update_limits(bool only_lower, double overshoot) {
  for (Partner* partner : partners_) {
    partner->finger->potential().update_limits(only_lower, overshoot);
  }
  parts_.contact.update_limits(number_, only_lower, overshoot);
}

}  // namespace softfinger
