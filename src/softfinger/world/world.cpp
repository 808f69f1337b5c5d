#include "softfinger/world/world.hpp"

#include <algorithm>

#include "softfinger/base/hash.hpp"
#include "softfinger/threads/thread_team.hpp"
#include "softfinger/world/world_implementation.hpp"

namespace softfinger {
namespace {

/// Bodies that one finger may touch at once and whose motion its directions know of; with more,
/// minimisation takes longer.
constexpr std::size_t kMostTouched = 8;

std::vector<double> masses_of(std::span<const VirtualObject> objects) {
  std::vector<double> masses;
  for (const VirtualObject& object : objects) {
    masses.push_back(object.dynamics ? object.dynamics->mass : 0.0);
  }
  return masses;
}

std::size_t soft_ones(std::span<const VirtualObject> objects) {
  const auto is_soft = [](const VirtualObject& object) { return object.soft != nullptr; };
  return static_cast<std::size_t>(std::ranges::count_if(objects, is_soft));
}

/// A jointed object does not touch what it hangs on.
std::vector<std::array<int, 2>> joined(std::span<const VirtualObject> objects) {
  std::vector<std::array<int, 2>> pairs;
  for (std::size_t o = 0; o < objects.size(); ++o) {
    if (!objects[o].dynamics || !objects[o].dynamics->joint) continue;
    const int parent = objects[o].dynamics->joint->parent;
    if (parent >= 0) pairs.push_back({static_cast<int>(o), parent});
  }
  return pairs;
}

}  // namespace

World::Implementation::Implementation(std::span<const VirtualObject> things, const Vector3& g,
                                      double dt, ThreadTeam* helpers)
    : objects(things),
      time_step(dt),
      team(helpers),
      tree(things),
      contact(things, masses_of(things), joined(things), dt),
      forces(tree, g, dt),
      rest(tree.bodies().size() + soft_ones(things), dt),
      places(tree.start()),
      poses(things.size()),
      expected(things.size()),
      states(things.size()),
      stirs(things.size()),
      island_of_object(things.size()),
      quiet(tree.bodies().size(), 0),
      pivots_O(things.size(), Vector3::Zero()),
      half_way(things.size(), Vector3::Zero()),
      appeared(things.size()) {
  for (std::size_t o = 0; o < things.size(); ++o) {
    if (things[o].soft) softs.push_back(std::make_unique<SoftBody>(things, o, g, dt, helpers));
  }
  has_begun.resize(softs.size());
  start();
  const WorldParts parts{tree, motions, forces, contact, soft_contact, partners, expected, places};
  const int threads = helpers != nullptr ? helpers->threads() : 1;
  for (int t = 0; t < threads; ++t) problems.push_back(std::make_unique<IslandProblem>(parts));
  reserve();
  for (const auto& soft : softs) {
    add(soft->simulation(), static_cast<int>(soft->object()));
  }
}

void World::Implementation::add(FingerSimulation& finger, int object) {
  partners.emplace_back(finger, partners.size(), std::min(kMostTouched, tree.bodies().size()));
  soft_contact.add(finger, object);
  reserve();
}

void World::Implementation::reserve() {
  boxes.resize(partners.size());
  takes_part.resize(partners.size());
  const std::size_t nodes = tree.bodies().size() + partners.size();
  islands = Islands(nodes);
  contact.reserve(nodes);
  near.reserve(partners.size());
  tasks.reserve(nodes);
  shared_tasks.reserve(nodes);
  of_tasks.reserve(partners.size());
  // What is soft is never solved beside others.
  for (const auto& problem : problems) {
    problem->reserve(problem == problems.front() && !softs.empty());
  }
}

void World::Implementation::start() {
  places = tree.start();
  motions = motions_at_start(tree, objects, places);
  for (std::size_t b = 0; b < motions.size(); ++b) {
    pivots_O[tree.bodies()[b].object] = motions[b].pivot();
  }
  std::ranges::fill(quiet, kSmoothAfter);
  rest.reset();
  contact.reset();
  for (std::size_t o = 0; o < objects.size(); ++o) poses[o] = objects[o].motion.sample(0.0);
  for (const auto& soft : softs) soft->reset();
  tell();
}

void World::Implementation::tell() {
  for (std::size_t b = 0; b < motions.size(); ++b) {
    const Body& body = tree.bodies()[b];
    states[body.object] = {.X_WO = motions[b].place().X_WO,
                           .velocity = motions[b].velocity(),
                           .angular_velocity = motions[b].angular_velocity(),
                           .joint = motions[b].place().q,
                           .has_joint = body.joint && body.freedoms == 1};
  }
  for (std::size_t s = 0; s < softs.size(); ++s) {
    if (!sleeps_soft(s)) tell_soft(s);
  }
}

void World::Implementation::begin_softs(double end) {
  const auto begins = [&](std::size_t s) { return !sleeps_soft(s) && has_begun[s] == 0; };
  for (std::size_t s = 0; s < softs.size(); ++s) {
    if (begins(s)) softs[s]->renew_surface();
  }
  for (std::size_t s = 0; s < softs.size(); ++s) {
    if (sleeps_soft(s)) continue;
    const std::size_t o = softs[s]->object();
    for (FingerSimulation* finger : fingers) {
      if (begins(s)) finger->find_patches(o, softs[s]->surface());
    }
    for (std::size_t other = 0; other < softs.size(); ++other) {
      if (other == s || sleeps_soft(other) || !(begins(s) || begins(other))) continue;
      softs[other]->simulation().find_patches(o, softs[s]->surface());
    }
  }
  for (std::size_t s = 0; s < softs.size(); ++s) {
    if (!begins(s)) continue;
    FingerSimulation& simulation = softs[s]->simulation();
    for (const Body& body : tree.bodies()) {
      simulation.expect_object(body.object, expected[body.object]);
    }
    softs[s]->begin_step(end);
    has_begun[s] = 1;
    const auto nodes = simulation.potential().positions();
    for (FingerSimulation* finger : fingers) finger->follow_surface(softs[s]->object(), nodes);
  }
}

void World::Implementation::end() {
  std::ranges::fill(half_way, Vector3::Zero());
  contact.add_turn_half_way(poses, expected, pivots_O, half_way);
  for (const Task& task : tasks) {
    for (const std::size_t b : task.island.bodies) {
      motions[b].end(places[b], half_way[tree.bodies()[b].object]);
      poses[tree.bodies()[b].object] = motions[b].place().X_WO;
    }
  }
  for (std::size_t o = 0; o < objects.size(); ++o) {
    if (!objects[o].dynamics) poses[o] = expected[o];
  }
  tell_events();
  contact.end(poses);
  for (std::size_t b = 0; b < motions.size(); ++b) {
    if (!acts(b)) continue;
    const std::size_t object = tree.bodies()[b].object;
    for (FingerSimulation* finger : fingers) finger->move_object(object, poses[object]);
    for (const auto& soft : softs) soft->simulation().move_object(object, poses[object]);
  }
  for (std::size_t s = 0; s < softs.size(); ++s) {
    if (sleeps_soft(s)) {
      softs[s]->simulation().pass_step(time);
    } else {
      softs[s]->simulation().end_step();
    }
  }
  look_for_rest();
  tell();
}

World::World(std::span<const VirtualObject> objects, const Vector3& gravity, double time_step,
             ThreadTeam* team)
    : implementation_(std::make_unique<Implementation>(objects, gravity, time_step, team)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

bool World::moves() const {
  return !implementation_->motions.empty() || !implementation_->softs.empty();
}

void World::add(FingerSimulation& finger) {
  Implementation& self = *implementation_;
  if (!moves()) return;
  self.add(finger);
  self.fingers.push_back(&finger);
}

void World::reset() {
  Implementation& self = *implementation_;
  self.start();
  self.forces.reset();
  for (Partner& partner : self.partners) partner.forget();
  self.soft_contact.forget();
  self.find_overlaps();
  self.prepare_events();
  self.time = 0.0;
  self.last = {};
  self.work = {};
  for (FingerSimulation* finger : self.fingers) {
    for (const Body& body : self.tree.bodies()) {
      finger->put_object(body.object, self.poses[body.object]);
    }
  }
  for (const auto& soft : self.softs) {
    for (const Body& body : self.tree.bodies()) {
      soft->simulation().put_object(body.object, self.poses[body.object]);
    }
  }
}

void World::follow(std::size_t o, const Pose* X_WT) {
  Implementation& self = *implementation_;
  const auto b = static_cast<std::size_t>(self.tree.body_of(o));
  const bool present = X_WT != nullptr;
  if (present != self.forces.is_nowhere(b)) {
    if (present) self.forces.follow(b, *X_WT);
    return;
  }
  const Pose X_WO = present ? *X_WT : Pose{Matrix3::Identity(), kNowhere};
  self.motions[b].rest_at(X_WO);
  self.forces.put(b, X_WO, present);
  self.contact.forget(o);
  self.appeared[o] = present ? 1 : 0;
  self.poses[o] = X_WO;
  for (FingerSimulation* finger : self.fingers) finger->put_object(o, X_WO);
  for (const auto& soft : self.softs) soft->simulation().put_object(o, X_WO);
  self.tell();
}

void World::hold(std::size_t o, const Pose* X_WT) {
  Implementation& self = *implementation_;
  const auto b = static_cast<std::size_t>(self.tree.body_of(o));
  self.forces.hold(b, self.motions[b].place().X_WO, X_WT);
  if (X_WT != nullptr) self.rest.wake(b);
}

void World::begin_step(double time) {
  Implementation& self = *implementation_;
  self.time = time;
  self.expect(time);
  self.find_appeared();
  for (FingerSimulation* finger : self.fingers) {
    for (const Body& body : self.tree.bodies()) {
      finger->expect_object(body.object, self.expected[body.object]);
    }
  }
  std::ranges::fill(self.has_begun, std::uint8_t{0});
  self.begin_softs(time);
}

void World::solve(std::span<FingerSimulation* const> fingers, std::span<StepSummary> summaries) {
  Implementation& self = *implementation_;
  if (!moves()) {  // fingers have not been added
    share(self.team, fingers.size(),
          [&](std::size_t f, int) { summaries[f] = fingers[f]->solve_step(); });
  }
  // A finger may have been put somewhere else since the step began.
  self.put_boxes();
  if (self.wake_near_partners()) {
    self.predict_awake(self.time);
    self.begin_softs(self.time);
  }
  self.find_islands(fingers);
  self.make_tasks();
  self.solve_tasks();
  for (const Implementation::Task& task : self.tasks) {
    for (const Partner* partner : task.island.partners) {
      const auto finger = std::ranges::find(fingers, partner->finger);
      if (finger == fingers.end()) continue;
      summaries[static_cast<std::size_t>(finger - fingers.begin())] = task.summary;
    }
  }
  self.count_quiet();
  self.end();
}

std::span<const Overlap> World::overlaps() const { return implementation_->overlaps; }
std::span<const WorldEvent> World::events() const { return implementation_->events->told(); }
void World::finish() { implementation_->events->finish(); }

std::size_t World::size() const { return implementation_->objects.size(); }
const ObjectState& World::state(std::size_t object) const {
  return implementation_->states[object];
}
std::span<const Vector3> World::nodes(std::size_t object) const {
  for (const auto& soft : implementation_->softs) {
    if (soft->object() == object) return soft->simulation().positions();
  }
  return {};
}
const StepSummary& World::summary() const { return implementation_->last; }
const StepWork& World::work() const { return implementation_->work; }

std::uint64_t World::state_hash() const {
  const Implementation& self = *implementation_;
  Hash hash;
  for (std::size_t b = 0; b < self.motions.size(); ++b) {
    self.motions[b].add_to(hash);
    self.forces.add_to(hash, b);
    self.rest.add_to(hash, b);
    hash.add(self.quiet[b]);
  }
  for (std::size_t s = 0; s < self.softs.size(); ++s) {
    self.rest.add_to(hash, self.number_of_soft(s));
  }
  for (std::size_t o = 0; o < self.objects.size(); ++o) self.contact.add_to(hash, o);
  for (const auto& soft : self.softs) hash.add(soft->simulation().state_hash());
  return hash.value();
}

}  // namespace softfinger
