#include "softfinger/finger/finger_simulation.hpp"

#include <algorithm>

#include "softfinger/base/hash.hpp"
#include "softfinger/contact/surface_patches.hpp"
#include "softfinger/finger/finger_contact.hpp"
#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/finger/minimise_in_cone.hpp"

namespace softfinger {
namespace {

/// Above this residual the inertial prediction is worse a start than where the finger was.
constexpr double kGoodPrediction = 2.0;
/// A rotation-warm-started decomposition and a chord factor are history; both start afresh this
/// often, so that rounding does not pile up.
constexpr std::uint64_t kRenewalSteps = 10000;

/// Stands in for that of a soft obstacle, whose patches count.
const Shape kNoShape = HalfSpace{};
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

void add(Hash& hash, const ElementStress& stress) {
  for (const auto& part : stress.part) hash.add(std::span<const double>(part));
}

}  // namespace

struct FingerSimulation::Implementation {
  Implementation(std::shared_ptr<const FingerModel> m, std::span<const VirtualObject> things,
                 std::size_t self, int own_hand, double dt, const FingerPotential::Options& options)
      : model(std::move(m)),
        objects(things),
        hand(own_hand),
        time_step(dt),
        potential(
            *model,
            self == kNone ? FingerPotential::Bone::kCoupled : FingerPotential::Bone::kPrescribed,
            things.size(), options),
        obstacles(things.size()),
        anchors(potential.contact().no_anchors()),
        positions(model->mesh.nodes),
        velocities(model->mesh.nodes.size(), Vector3::Zero()),
        history(potential.elastic().make_history()),
        old_velocities(velocities),
        extrapolated(velocities),
        samples(model->sample_nodes.size()),
        contact(make_contact_set(*model)) {
    for (std::size_t o = 0; o < things.size(); ++o) {
      // What is soft is met by patches alone, and what is not to be met has none.
      obstacles[o].is_soft = things[o].soft != nullptr || !may_touch(o);
      obstacles[o].shape = obstacles[o].is_soft ? &kNoShape : &things[o].shape;
      obstacles[o].friction_coefficient =
          self == kNone ? things[o].friction_coefficient.value_or(model->friction_coefficient)
                        : friction_between(things[self], things[o]);
      // A soft object does not meet itself.
      patches.emplace_back(things[o].soft != nullptr && o != self ? samples.size() : 0);
      obstacles[o].moves = things[o].dynamics.has_value();
      obstacles[o].X_WO = things[o].motion.sample(0.0);
    }
    for (std::size_t o = 0; o < things.size(); ++o) obstacles[o].patches = patches[o].patches();
  }

  [[nodiscard]] bool may_touch(std::size_t o) const {
    return hand < 0 || objects[o].hand() != hand;
  }

  void place_obstacles(double time) {
    for (std::size_t o = 0; o < objects.size(); ++o) {
      if (obstacles[o].moves) continue;  // see put_object(), expect_object()
      obstacles[o].X_WO_old = obstacles[o].X_WO;
      obstacles[o].X_WO = objects[o].motion.sample(time);
    }
  }

  void begin(const Pose& X_WFt) {
    FingerPotential::Step step;
    step.time_step = time_step;
    step.old_positions = positions;
    step.velocities = velocities;
    step.old_bone = bone;
    step.X_WFt_old = tracked;
    step.X_WFt = X_WFt;
    step.obstacles = obstacles;
    step.anchors = anchors;
    step.history = &history;
    potential.begin(step);
  }

  /// Where the motion of the last two steps leads if it goes on evenly; else where it leads without
  /// forces; else where the finger is.
  void start() {
    for (std::size_t n = 0; n < positions.size(); ++n) {
      extrapolated[n] = positions[n] + time_step * (2.0 * velocities[n] - old_velocities[n]);
    }
    Pose X_WF;
    X_WF.translation =
        bone.X_WF.translation + time_step * (2.0 * bone.velocity - old_bone.velocity);
    X_WF.rotation = orthonormalised(
        bone.X_WF.rotation + time_step * (2.0 * bone.rotation_rate - old_bone.rotation_rate));
    potential.start_from(extrapolated, X_WF);
    if (potential.residual() < kGoodPrediction) return;
    potential.start_from_prediction();
    if (potential.residual() < kGoodPrediction) return;
    potential.start_from(positions, bone.X_WF);
  }

  void finish() {
    std::swap(velocities, old_velocities);
    old_bone = bone;
    const double rate = 1.0 / time_step;
    const std::span<const Vector3> now = potential.positions();
    for (std::size_t n = 0; n < positions.size(); ++n) {
      velocities[n] = rate * (now[n] - positions[n]);
      positions[n] = now[n];
    }
    Pose X_WF = potential.bone_pose();
    X_WF.rotation = orthonormalised(X_WF.rotation);
    bone.velocity = rate * (X_WF.translation - bone.X_WF.translation);
    bone.rotation_rate = rate * (X_WF.rotation - bone.X_WF.rotation);
    bone.X_WF = X_WF;
    tracked = next_tracked;
    potential.settle();
    potential.elastic().end_step(potential.elastic_work(), time_step, history);
    potential.contact().update_anchors(potential.contact_positions(), anchors);
    report_contact(*model, potential, contact);
  }

  std::shared_ptr<const FingerModel> model;
  std::span<const VirtualObject> objects;
  int hand;  ///< whose finger it is; -1: none's
  double time_step;
  FingerPotential potential;
  std::vector<Obstacle> obstacles;
  std::vector<FrictionAnchor> anchors;
  std::vector<SurfacePatches> patches;  ///< by object; of none that is rigid
  std::vector<Vector3> positions, velocities;
  StressHistory history;
  BoneState bone;
  // Only for the start of the next step.
  std::vector<Vector3> old_velocities, extrapolated;
  BoneState old_bone;
  Pose tracked, next_tracked;    ///< at the start and the end of the step
  std::vector<Vector3> samples;  ///< where they are at the start of a step, W, m
  ContactSet contact;
  std::uint64_t steps = 0;
};

FingerSimulation::FingerSimulation(std::shared_ptr<const FingerModel> model,
                                   std::span<const VirtualObject> objects, double time_step,
                                   ThreadTeam* team, int hand)
    : implementation_(std::make_unique<Implementation>(std::move(model), objects, kNone, hand,
                                                       time_step,
                                                       FingerPotential::Options{.team = team})) {
  reset(Pose{});
}
FingerSimulation::FingerSimulation(std::span<const VirtualObject> objects, std::size_t self,
                                   const Vector3& gravity, double time_step, ThreadTeam* team)
    : implementation_(std::make_unique<Implementation>(
          std::make_shared<const FingerModel>(*objects[self].soft), objects, self, -1, time_step,
          FingerPotential::Options{.team = team, .gravity = gravity})) {
  reset(objects[self].motion.sample(0.0));
}
FingerSimulation::~FingerSimulation() = default;
FingerSimulation::FingerSimulation(FingerSimulation&&) noexcept = default;
FingerSimulation& FingerSimulation::operator=(FingerSimulation&&) noexcept = default;

void FingerSimulation::reset(const Pose& X_WFt, double time) {
  Implementation& self = *implementation_;
  self.bone = BoneState{};
  self.bone.X_WF = X_WFt;
  self.old_bone = self.bone;
  self.tracked = X_WFt;
  self.steps = 0;
  for (std::size_t n = 0; n < self.positions.size(); ++n) {
    self.positions[n] = X_WFt * self.model->mesh.nodes[n];
    self.velocities[n].setZero();
    self.old_velocities[n].setZero();
  }
  for (FrictionAnchor& anchor : self.anchors) anchor = FrictionAnchor{};
  for (SurfacePatches& patches : self.patches) patches.clear();
  std::ranges::fill(self.potential.loads(), Vector3::Zero());
  forget(self.history);
  self.place_obstacles(time);
  for (Obstacle& obstacle : self.obstacles) obstacle.X_WO_old.reset();
  self.potential.forget();
  self.potential.forget_features();
  self.begin(X_WFt);
  self.potential.start_from(self.positions, X_WFt);
  report_contact(*self.model, self.potential, self.contact);
}

void FingerSimulation::put_aside(const Pose& X_WFt) {
  reset(X_WFt);
  implementation_->contact = make_contact_set(*implementation_->model);
}

StepSummary FingerSimulation::step(const Pose& X_WFt, double time) {
  begin_step(X_WFt, time);
  const StepSummary summary = solve_step();
  end_step();
  return summary;
}

StepSummary FingerSimulation::solve_step() {
  const NewtonSummary summary = minimise_in_cone(implementation_->potential, NewtonOptions{});
  return {summary.iterations, summary.converged, summary.residual};
}

void FingerSimulation::begin_step(const Pose& X_WFt, double time) {
  Implementation& self = *implementation_;
  if (self.steps % kRenewalSteps == 0) self.potential.forget();
  ++self.steps;
  self.place_obstacles(time);
  self.next_tracked = X_WFt;
  self.begin(X_WFt);
  self.start();
}

void FingerSimulation::end_step() { implementation_->finish(); }

void FingerSimulation::pass_step(double time) { implementation_->place_obstacles(time); }

void FingerSimulation::rest() {
  Implementation& self = *implementation_;
  std::ranges::fill(self.velocities, Vector3::Zero());
  std::ranges::fill(self.old_velocities, Vector3::Zero());
  self.bone.velocity.setZero();
  self.bone.rotation_rate.setZero();
  self.old_bone = self.bone;
}

void FingerSimulation::put_object(std::size_t o, const Pose& X_WO) {
  implementation_->obstacles[o].X_WO = X_WO;
  implementation_->obstacles[o].X_WO_old.reset();
}

void FingerSimulation::expect_object(std::size_t o, const Pose& X_WO) {
  Obstacle& obstacle = implementation_->obstacles[o];
  obstacle.X_WO_old = obstacle.X_WO;
  obstacle.X_WO = X_WO;
}

void FingerSimulation::move_object(std::size_t o, const Pose& X_WO) {
  if (!may_touch(o)) return;
  implementation_->obstacles[o].X_WO = X_WO;
  implementation_->potential.follow_obstacle(o);
}

void FingerSimulation::find_patches(std::size_t o, const DeformingSurface& surface) {
  Implementation& self = *implementation_;
  for (std::size_t i = 0; i < self.samples.size(); ++i) {
    self.samples[i] = self.positions[static_cast<std::size_t>(self.model->sample_nodes[i])];
  }
  self.patches[o].find(surface, self.samples, o, self.objects.size(), self.anchors);
}

void FingerSimulation::follow_surface(std::size_t o, std::span<const Vector3> nodes) {
  implementation_->patches[o].follow(nodes);
}

const SurfacePatches& FingerSimulation::patches(std::size_t o) const {
  return implementation_->patches[o];
}

FingerPotential& FingerSimulation::potential() { return implementation_->potential; }

const FingerPotential& FingerSimulation::potential() const { return implementation_->potential; }

const FingerModel& FingerSimulation::model() const { return *implementation_->model; }
bool FingerSimulation::may_touch(std::size_t o) const { return implementation_->may_touch(o); }
const Pose& FingerSimulation::bone_pose() const { return implementation_->bone.X_WF; }
const ContactSet& FingerSimulation::contact() const { return implementation_->contact; }
std::span<const Vector3> FingerSimulation::positions() const { return implementation_->positions; }
std::span<const Vector3> FingerSimulation::velocities() const {
  return implementation_->velocities;
}

std::uint64_t FingerSimulation::state_hash() const {
  const Implementation& self = *implementation_;
  Hash hash;
  for (const Vector3& x : self.positions) hash.add(x);
  for (const Vector3& v : self.velocities) hash.add(v);
  hash.add(self.bone.X_WF.translation);
  hash.add(self.bone.X_WF.rotation);
  hash.add(self.bone.velocity);
  hash.add(self.bone.rotation_rate);
  const std::size_t count = self.objects.size();
  for (std::size_t k = 0; k < self.anchors.size(); ++k) {
    if (!self.may_touch(k % count)) continue;
    const FrictionAnchor& anchor = self.anchors[k];
    hash.add(anchor.anchor_O);
    hash.add(anchor.limit);
    if (anchor.side.known) hash.add(anchor.side.point_O).add(anchor.side.normal_O);
  }
  for (const ElementStress& stress : self.history.elastic) add(hash, stress);
  for (const auto& term : self.history.relaxing) {
    for (const ElementStress& stress : term) add(hash, stress);
  }
  return hash.value();
}

}  // namespace softfinger
