#include "softfinger/world/world.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "softfinger/base/hash.hpp"
#include "softfinger/contact/surface_patches.hpp"
#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/finger/minimise_in_cone.hpp"
#include "softfinger/threads/thread_team.hpp"
#include "softfinger/world/soft_body.hpp"
#include "softfinger/world/world_problem.hpp"

namespace softfinger {
namespace {

/// A finger this near to an object that moves takes part in its step, m.
constexpr double kTakesPart = 5e-3;
/// Steps without contact after which motion counts as smooth.
constexpr int kSmoothAfter = 2;
/// Residual of a step without fingers, whose matrix is exact.
constexpr double kBodiesTolerance = 1e-10;

std::vector<double> masses_of(std::span<const VirtualObject> objects) {
  std::vector<double> masses;
  for (const VirtualObject& object : objects) {
    masses.push_back(object.dynamics ? object.dynamics->mass : 0.0);
  }
  return masses;
}

/// What a finger could touch, W.
Eigen::AlignedBox3d box_around(const FingerSimulation& finger) {
  Eigen::AlignedBox3d box;
  for (const Vector3& p : finger.positions()) box.extend(p);
  box.min().array() -= kTakesPart;
  box.max().array() += kTakesPart;
  return box;
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

/// Of the velocity that the scene gives a body at the start, what its joint allows: a rate by each
/// of its own coordinates. A hinge takes the turn about its axis, or where that is none, the way of
/// the centre of mass; a ball the turn.
Vector3 start_rates(std::span<const BodyTree::Column> own, const ObjectDynamics& starts,
                    const Vector3& centre_from_origin) {
  Vector3 rates = Vector3::Zero();
  if (own.size() > 1) return starts.angular_velocity_W;
  for (const BodyTree::Column& column : own) {
    const Vector3 turn = column.twist.tail<3>();
    const Vector3 way = column.twist.head<3>() + turn.cross(centre_from_origin);
    rates[0] = turn.dot(starts.angular_velocity_W);
    if (rates[0] == 0.0 && way.squaredNorm() > 0.0) {
      rates[0] = way.dot(starts.velocity_W) / way.squaredNorm();
    }
  }
  return rates;
}

}  // namespace

struct World::Implementation {
  Implementation(std::span<const VirtualObject> things, const Vector3& g, double dt,
                 ThreadTeam* helpers)
      : objects(things),
        time_step(dt),
        team(helpers),
        tree(things),
        contact(things, masses_of(things), joined(things), dt),
        poses(things.size()),
        expected(things.size()),
        states(things.size()),
        quiet(tree.bodies().size(), 0) {
    for (std::size_t o = 0; o < things.size(); ++o) {
      if (things[o].soft) softs.push_back(std::make_unique<SoftBody>(things, o, g, dt, helpers));
    }
    start();
    problem = std::make_unique<WorldProblem>(tree, motions, contact, g, dt, helpers);
    for (const auto& soft : softs) {
      problem->reserve(soft->simulation(), static_cast<int>(soft->object()));
    }
    near.reserve(softs.size());
    boxes.resize(softs.size());
  }

  void start() {
    places = tree.start();
    std::vector<BodyTree::Columns> columns(places.size());
    tree.columns(places, 0.0, columns);
    motions.clear();
    for (std::size_t b = 0; b < places.size(); ++b) {
      const Body& body = tree.bodies()[b];
      const ObjectDynamics& starts = *objects[body.object].dynamics;
      const Vector3 centre = tree.centre(b, places[b].X_WO) - places[b].X_WO.translation;
      Vector3 velocity = starts.velocity_W;
      Vector3 spin = starts.angular_velocity_W;
      double rate = 0.0;
      if (body.joint) {
        const std::span<const BodyTree::Column> all = columns[b].all();
        const auto own = all.last(static_cast<std::size_t>(body.freedoms));
        const Vector3 rates = start_rates(own, starts, centre);
        if (body.freedoms == 1) rate = rates[0];
        Vector6 twist = Vector6::Zero();  // of O's origin
        for (std::size_t c = 0; c < own.size(); ++c) {
          twist += rates[static_cast<int>(c)] * own[c].twist;
        }
        if (body.parent >= 0) {
          const auto p = static_cast<std::size_t>(body.parent);
          const Vector3 turn = motions[p].angular_velocity();
          const Vector3 way = places[b].X_WO.translation - tree.centre(p, places[p].X_WO);
          twist.head<3>() += motions[p].velocity() + turn.cross(way);
          twist.tail<3>() += turn;
        }
        spin = twist.tail<3>();
        velocity = twist.head<3>() + spin.cross(centre);
      }
      motions.emplace_back(body, places[b], velocity, spin, rate);
    }
    std::fill(quiet.begin(), quiet.end(), kSmoothAfter);
    contact.reset();
    for (std::size_t o = 0; o < objects.size(); ++o) poses[o] = objects[o].motion.sample(0.0);
    for (const auto& soft : softs) soft->reset();
    tell();
  }

  void tell() {
    for (std::size_t b = 0; b < motions.size(); ++b) {
      const Body& body = tree.bodies()[b];
      states[body.object] = {.X_WO = motions[b].place().X_WO,
                             .velocity = motions[b].velocity(),
                             .angular_velocity = motions[b].angular_velocity(),
                             .joint = motions[b].place().q,
                             .has_joint = body.joint && body.freedoms == 1};
    }
    for (const auto& soft : softs) states[soft->object()] = soft->state();
  }

  /// Soft objects begin, and all that may touch their surfaces knows where.
  void begin_softs(double end) {
    for (const auto& soft : softs) soft->renew_surface();
    for (const auto& soft : softs) {
      const std::size_t o = soft->object();
      for (FingerSimulation* finger : fingers) finger->find_patches(o, soft->surface());
      for (const auto& other : softs) {
        if (other != soft) other->simulation().find_patches(o, soft->surface());
      }
    }
    for (const auto& soft : softs) {
      for (const Body& body : tree.bodies()) {
        soft->simulation().expect_object(body.object, expected[body.object]);
      }
      soft->begin_step(end);
    }
    for (const auto& soft : softs) {
      const auto nodes = soft->simulation().potential().positions();
      for (FingerSimulation* finger : fingers) finger->follow_surface(soft->object(), nodes);
    }
  }

  void expect(double end) {
    for (std::size_t o = 0; o < objects.size(); ++o) {
      expected[o] = poses[o];
      if (!objects[o].dynamics) expected[o] = objects[o].motion.sample(end);
    }
    predict(end);
    // What may touch in this step takes blows as they are: the second order would make them ring.
    if (roughen()) predict(end);
  }

  void predict(double end) {
    for (std::size_t b = 0; b < motions.size(); ++b) {
      const Body& body = tree.bodies()[b];
      const bool pulled = tree.following(b) || problem->is_held(b);
      motions[b].begin(time_step, quiet[b] >= kSmoothAfter && !pulled);
      places[b] = motions[b].prediction();
      if (body.joint) tree.put_on_parent(b, end, places);
      motions[b].refer_to(places[b].X_WO);
      expected[body.object] = places[b].X_WO;
    }
    contact.begin(poses, expected);
  }

  bool roughen() {
    bool any = false;
    for (std::size_t f = 0; f < fingers.size(); ++f) boxes[f] = box_around(*fingers[f]);
    for (std::size_t s = 0; s < softs.size(); ++s) {
      boxes[fingers.size() + s] = box_around(softs[s]->simulation());
    }
    for (std::size_t b = 0; b < quiet.size(); ++b) {
      const std::size_t object = tree.bodies()[b].object;
      if (tree.following(b)) continue;
      const bool near_finger = std::ranges::any_of(
          boxes, [&](const Eigen::AlignedBox3d& box) { return reaches(box, object); });
      if (quiet[b] < kSmoothAfter || !(contact.is_near(object) || near_finger)) continue;
      quiet[b] = 0;
      any = true;
    }
    if (any) spread_roughness();
    return any;
  }

  [[nodiscard]] bool is_near(const FingerSimulation& finger) const {
    const auto meets = [&](const auto& soft) { return finger.patches(soft->object()).any(); };
    if (std::ranges::any_of(softs, meets)) return true;
    const Eigen::AlignedBox3d box = box_around(finger);
    return std::ranges::any_of(tree.bodies(), [&](const Body& body) {
      return finger.may_touch(body.object) && reaches(box, body.object);
    });
  }

  /// Whether an object comes into the box in this step.
  [[nodiscard]] bool reaches(const Eigen::AlignedBox3d& box, std::size_t object) const {
    const Eigen::AlignedBox3d own = bounds(objects[object].shape);
    const Vector3 half = 0.5 * own.sizes();
    const auto covers = [&](const Pose& X_WO) {
      const Vector3 centre = X_WO * Vector3(own.min() + half);
      const Vector3 extent = X_WO.rotation.cwiseAbs() * half;
      return box.intersects({centre - extent, centre + extent});
    };
    return covers(poses[object]) || covers(expected[object]);
  }

  void end() {
    problem->end();
    const std::span<const BodyPlace> ended = problem->places();
    for (std::size_t b = 0; b < motions.size(); ++b) motions[b].end(ended[b]);
    for (std::size_t o = 0; o < objects.size(); ++o) {
      if (!objects[o].dynamics) poses[o] = expected[o];
    }
    for (std::size_t b = 0; b < motions.size(); ++b) {
      poses[tree.bodies()[b].object] = motions[b].place().X_WO;
    }
    tell_events();
    contact.end(poses);
    for (const Body& body : tree.bodies()) {
      const Pose& X_WO = poses[body.object];
      for (FingerSimulation* finger : fingers) finger->move_object(body.object, X_WO);
      for (const auto& soft : softs) soft->simulation().move_object(body.object, X_WO);
    }
    for (const auto& soft : softs) soft->simulation().end_step();
    tell();
  }

  void find_overlaps() {
    overlaps.clear();
    contact.begin(poses, poses);
    contact.for_each_sunk([&](std::size_t of, std::size_t on, double depth) {
      const auto known = std::ranges::find_if(overlaps, [&](const Overlap& overlap) {
        return overlap.first == std::min(of, on) && overlap.second == std::max(of, on);
      });
      if (known == overlaps.end()) {
        overlaps.push_back({std::min(of, on), std::max(of, on), depth});
      } else {
        known->depth = std::max(known->depth, depth);
      }
    });
  }

  void prepare_events() {
    std::vector<int> moving;
    std::vector<WorldEvents::Joint> joints;
    for (const auto& soft : softs) moving.push_back(static_cast<int>(soft->object()));
    for (std::size_t b = 0; b < motions.size(); ++b) {
      const Body& body = tree.bodies()[b];
      moving.push_back(static_cast<int>(body.object));
      const JointLaw* const law = problem->law(b);
      if (law == nullptr) continue;
      const bool slides = body.joint->kind == JointKind::kSlider;
      joints.push_back({.object = static_cast<int>(body.object),
                        .mass = slides ? body.inertia.mass : 0.0,
                        .snaps = law->snaps()});
    }
    events.emplace(moving, objects.size(), fingers.size(), joints, time_step);
  }

  void tell_events() {
    contact.for_each_pressing([&](std::size_t of, std::size_t on, double force) {
      events->touch(static_cast<int>(of), static_cast<int>(on), force);
    });
    for (std::size_t f = 0; f < fingers.size(); ++f) {
      if (std::ranges::find(near, fingers[f]) == near.end()) continue;
      for (const Body& body : tree.bodies()) {
        const ContactPotential& skin = fingers[f]->potential().contact();
        events->touch(static_cast<int>(body.object), static_cast<int>(objects.size() + f),
                      skin.wrench(body.object).normal_force);
      }
      for (const auto& soft : softs) {
        const ContactPotential& skin = fingers[f]->potential().contact();
        events->touch(static_cast<int>(soft->object()), static_cast<int>(objects.size() + f),
                      skin.wrench(soft->object()).normal_force);
      }
    }
    for (const auto& soft : softs) {
      for (std::size_t o = 0; o < objects.size(); ++o) {
        events->touch(static_cast<int>(soft->object()), static_cast<int>(o),
                      soft->simulation().potential().contact().wrench(o).normal_force);
      }
    }
    std::size_t joint = 0;
    for (std::size_t b = 0; b < motions.size(); ++b) {
      const JointLaw* const law = problem->law(b);
      if (law == nullptr) continue;
      const double q = motions[b].place().q;
      events->joint(joint++,
                    {.q = q, .limit_force = law->limit_force(q), .detent = law->detent(q)});
    }
    events->end_step();
  }

  /// Anything that a body, or what hangs together with it, touches makes its motion rough.
  void count_quiet() {
    const auto touched = [&](std::size_t object) {
      if (contact.touches(object)) return true;
      return std::ranges::any_of(near, [&](FingerSimulation* finger) {
        return finger->potential().contact().wrench(object).by_translation.squaredNorm() > 0.0;
      });
    };
    for (std::size_t b = 0; b < quiet.size(); ++b) {
      quiet[b] = touched(tree.bodies()[b].object) ? 0 : std::min(quiet[b] + 1, kSmoothAfter);
    }
    spread_roughness();
  }

  /// To all that hang together.
  void spread_roughness() {
    for (std::size_t b = quiet.size(); b-- > 0;) {
      const int parent = tree.bodies()[b].parent;
      if (parent < 0) continue;
      int& own = quiet[static_cast<std::size_t>(parent)];
      own = std::min(own, quiet[b]);
    }
    for (std::size_t b = 0; b < quiet.size(); ++b) {
      const int parent = tree.bodies()[b].parent;
      if (parent >= 0) quiet[b] = std::min(quiet[b], quiet[static_cast<std::size_t>(parent)]);
    }
  }

  std::span<const VirtualObject> objects;
  double time_step;
  ThreadTeam* team;
  BodyTree tree;
  SolidContact contact;
  std::vector<BodyMotion> motions;
  std::unique_ptr<WorldProblem> problem;
  std::vector<BodyPlace> places;
  std::vector<Pose> poses, expected;  ///< of objects, at the start of the step and at its end
  std::vector<ObjectState> states;
  std::vector<int> quiet;  ///< by body: steps without contact
  std::vector<std::unique_ptr<SoftBody>> softs;
  std::vector<FingerSimulation*> fingers, near;
  std::vector<Eigen::AlignedBox3d> boxes;  ///< about each finger, and each soft object
  std::vector<std::size_t> alone;
  double time = 0.0;
  std::optional<WorldEvents> events;
  std::vector<Overlap> overlaps;  ///< at the start
  StepSummary last;
};

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
  self.problem->reserve(finger);
  self.fingers.push_back(&finger);
  self.boxes.resize(self.fingers.size() + self.softs.size());
  self.near.reserve(self.fingers.size() + self.softs.size());
  self.alone.reserve(self.fingers.size());
}

void World::reset() {
  Implementation& self = *implementation_;
  self.start();
  self.problem->reset();
  self.find_overlaps();
  self.prepare_events();
  self.time = 0.0;
  self.last = {};
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
  if (present == self.problem->is_present(b)) {
    if (present) self.problem->follow(b, *X_WT);
    return;
  }
  const Pose X_WO = present ? *X_WT : Pose{Matrix3::Identity(), kNowhere};
  self.motions[b].rest_at(X_WO);
  self.problem->put(b, X_WO, present);
  self.poses[o] = X_WO;
  for (FingerSimulation* finger : self.fingers) finger->put_object(o, X_WO);
  for (const auto& soft : self.softs) soft->simulation().put_object(o, X_WO);
  self.tell();
}

void World::hold(std::size_t o, const Pose* X_WT) {
  const auto b = static_cast<std::size_t>(implementation_->tree.body_of(o));
  implementation_->problem->hold(b, X_WT);
}

void World::begin_step(double time) {
  Implementation& self = *implementation_;
  self.time = time;
  self.expect(time);
  for (FingerSimulation* finger : self.fingers) {
    for (const Body& body : self.tree.bodies()) {
      finger->expect_object(body.object, self.expected[body.object]);
    }
  }
  self.begin_softs(time);
}

void World::solve(std::span<FingerSimulation* const> fingers, std::span<StepSummary> summaries) {
  Implementation& self = *implementation_;
  self.near.clear();
  self.alone.clear();
  for (std::size_t f = 0; f < fingers.size(); ++f) {
    if (self.is_near(*fingers[f])) {
      self.near.push_back(fingers[f]);
    } else {
      self.alone.push_back(f);
    }
  }
  const auto solve_alone = [&](std::size_t k, int) {
    const std::size_t f = self.alone[k];
    summaries[f] = fingers[f]->solve_step();
  };
  if (self.team != nullptr) {
    self.team->run(self.alone.size(), solve_alone);
  } else {
    for (std::size_t k = 0; k < self.alone.size(); ++k) solve_alone(k, 0);
  }
  for (const auto& soft : self.softs) self.near.push_back(&soft->simulation());
  std::vector<Pose>& at_end = self.expected;
  self.problem->begin(self.time, at_end, self.places, self.near);
  NewtonOptions options;
  if (self.near.empty()) options.tolerance = kBodiesTolerance;
  const NewtonSummary summary = minimise_in_cone(*self.problem, options);
  self.problem->settle();
  self.last = {summary.iterations, summary.converged, summary.residual};
  for (std::size_t f = 0; f < fingers.size(); ++f) {
    if (std::ranges::find(self.near, fingers[f]) != self.near.end()) summaries[f] = self.last;
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

std::uint64_t World::state_hash() const {
  const Implementation& self = *implementation_;
  Hash hash;
  for (const BodyMotion& motion : self.motions) motion.add_to(hash);
  for (std::size_t b = 0; b < self.motions.size(); ++b) hash.add(self.problem->anchor(b));
  self.contact.add_to(hash);
  self.problem->add_to(hash);
  for (const int steps : self.quiet) hash.add(steps);
  for (const auto& soft : self.softs) hash.add(soft->simulation().state_hash());
  return hash.value();
}

}  // namespace softfinger
