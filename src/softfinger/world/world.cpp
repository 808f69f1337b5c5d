#include "softfinger/world/world.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "softfinger/base/hash.hpp"
#include "softfinger/contact/surface_patches.hpp"
#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/threads/thread_team.hpp"
#include "softfinger/world/body_rest.hpp"
#include "softfinger/world/body_start.hpp"
#include "softfinger/world/island_problem.hpp"
#include "softfinger/world/islands.hpp"
#include "softfinger/world/minimise_island.hpp"
#include "softfinger/world/soft_body.hpp"

namespace softfinger {
namespace {

/// A finger this near to an object that moves takes part in its step, m.
constexpr double kTakesPart = 5e-3;
/// Steps without contact after which motion counts as smooth.
constexpr int kSmoothAfter = 2;
/// Residual of an island without fingers, whose matrix is exact.
constexpr double kBodiesTolerance = 1e-10;
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

/// What a finger could touch, W.
Eigen::AlignedBox3d box_around(const FingerSimulation& finger) {
  Eigen::AlignedBox3d box;
  for (const Vector3& p : finger.positions()) box.extend(p);
  box.min().array() -= kTakesPart;
  box.max().array() += kTakesPart;
  return box;
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

struct World::Implementation {
  Implementation(std::span<const VirtualObject> things, const Vector3& g, double dt,
                 ThreadTeam* helpers)
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
        appeared(things.size()) {
    for (std::size_t o = 0; o < things.size(); ++o) {
      if (things[o].soft) softs.push_back(std::make_unique<SoftBody>(things, o, g, dt, helpers));
    }
    has_begun.resize(softs.size());
    start();
    const WorldParts parts{tree,         motions,  forces,   contact,
                           soft_contact, partners, expected, places};
    const int threads = helpers != nullptr ? helpers->threads() : 1;
    for (int t = 0; t < threads; ++t) problems.push_back(std::make_unique<IslandProblem>(parts));
    reserve();
    for (const auto& soft : softs) {
      add(soft->simulation(), static_cast<int>(soft->object()));
    }
  }

  void add(FingerSimulation& finger, int object = -1) {
    partners.emplace_back(finger, partners.size(), std::min(kMostTouched, tree.bodies().size()));
    soft_contact.add(finger, object);
    reserve();
  }

  /// For the partners that there are.
  void reserve() {
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

  void start() {
    places = tree.start();
    motions = motions_at_start(tree, objects, places);
    std::ranges::fill(quiet, kSmoothAfter);
    rest.reset();
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
    for (std::size_t s = 0; s < softs.size(); ++s) {
      if (!sleeps_soft(s)) tell_soft(s);
    }
  }
  void tell_soft(std::size_t s) { states[softs[s]->object()] = softs[s]->state(); }

  /// Number of a soft object among what rests and hangs together: after the bodies, as partners.
  [[nodiscard]] std::size_t number_of_soft(std::size_t s) const { return motions.size() + s; }
  [[nodiscard]] bool sleeps_soft(std::size_t s) const { return rest.sleeps(number_of_soft(s)); }
  [[nodiscard]] bool sleeps(const Partner& partner) const {
    return partner.number < softs.size() && sleeps_soft(partner.number);
  }

  /// Soft objects that are awake begin, and all that may touch their surfaces knows where; once
  /// more in the same step where others have woken.
  void begin_softs(double end) {
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

  using Stir = SolidContact::Motion;

  void expect(double end) {
    for (std::size_t o = 0; o < objects.size(); ++o) {
      expected[o] = poses[o];
      stirs[o] = Stir::kLies;
      if (objects[o].dynamics) continue;
      expected[o] = objects[o].motion.sample(end);
      const bool same = expected[o].rotation == poses[o].rotation &&
                        expected[o].translation == poses[o].translation;
      if (!same) stirs[o] = Stir::kStirs;
    }
    for (std::size_t b = 0; b < motions.size(); ++b) {
      if (rest.sleeps(b) && hangs_on_moving(b)) rest.wake(b);
    }
    put_boxes();
    predict_awake(end);
    // What may touch in this step takes blows as they are: the second order would make them ring.
    if (roughen()) predict(end);
  }

  /// Whether a script moves what its joint hangs on in this step.
  [[nodiscard]] bool hangs_on_moving(std::size_t b) const {
    const Body& body = tree.bodies()[b];
    if (!body.joint || body.joint->parent < 0 || body.parent >= 0) return false;
    return stirs[static_cast<std::size_t>(body.joint->parent)] == Stir::kStirs;
  }

  void put_boxes() {
    for (std::size_t p = 0; p < partners.size(); ++p) boxes[p] = box_around(*partners[p].finger);
  }

  /// Of partners: the soft objects come first.
  [[nodiscard]] std::span<const Partner> those_of_fingers() const {
    return std::span(partners).subspan(softs.size());
  }

  /// Whether one of some partners comes near the rigid object in this step, awake.
  [[nodiscard]] bool is_near(std::size_t object, std::span<const Partner> some) const {
    return std::ranges::any_of(some, [&](const Partner& partner) {
      return !sleeps(partner) && partner.finger->may_touch(object) &&
             reaches(boxes[partner.number], object);
    });
  }

  /// Whether a soft object is moved, or something comes near it, that no forces of its island move.
  [[nodiscard]] bool is_disturbed(std::size_t s) const {
    if (stirs[softs[s]->object()] == Stir::kStirs) return true;
    for (const Partner& partner : those_of_fingers()) {
      if (boxes[s].intersects(boxes[partner.number])) return true;
    }
    for (std::size_t o = 0; o < objects.size(); ++o) {
      if (tree.body_of(o) < 0 && stirs_near(s, o)) return true;
    }
    return false;
  }

  /// Whether something rigid stirs near a soft object.
  [[nodiscard]] bool stirs_near(std::size_t s, std::size_t object) const {
    return stirs[object] == Stir::kStirs && objects[object].soft == nullptr &&
           reaches(boxes[s], object);
  }

  /// Whether anything that stirs comes near a soft object that sleeps.
  [[nodiscard]] bool is_met(std::size_t s) const {
    if (is_disturbed(s)) return true;
    for (std::size_t other = 0; other < softs.size(); ++other) {
      if (!sleeps_soft(other) && boxes[s].intersects(boxes[other])) return true;
    }
    return std::ranges::any_of(tree.bodies(),
                               [&](const Body& body) { return stirs_near(s, body.object); });
  }

  /// Fingers and soft objects wake what they come near, and what stirs soft objects.
  bool wake_near_partners() {
    bool any = false;
    for (std::size_t b = 0; b < motions.size(); ++b) {
      if (!rest.sleeps(b) || !is_near(tree.bodies()[b].object, partners)) continue;
      rest.wake(b);
      any = true;
    }
    for (std::size_t s = 0; s < softs.size(); ++s) {
      if (!sleeps_soft(s) || !is_met(s)) continue;
      rest.wake(number_of_soft(s));
      any = true;
    }
    return any;
  }

  /// Where bodies are expected, and who is near whom; wakes what something comes near that stirs.
  void predict_awake(double end) {
    for (bool woken = true; woken;) {
      predict(end);
      woken = wake_near_partners();
      contact.for_each_near([&](std::size_t of, std::size_t on) {
        for (const std::size_t o : {of, on}) {
          const int b = tree.body_of(o);
          if (b < 0 || !rest.sleeps(static_cast<std::size_t>(b))) continue;
          rest.wake(static_cast<std::size_t>(b));
          woken = true;
        }
      });
    }
  }

  void predict(double end) {
    for (std::size_t b = 0; b < motions.size(); ++b) {
      const Body& body = tree.bodies()[b];
      if (forces.is_nowhere(b)) stirs[body.object] = Stir::kAbsent;
      if (!acts(b)) continue;
      stirs[body.object] = Stir::kStirs;
      const bool pulled = forces.pull_on(b) != nullptr;
      motions[b].begin(time_step, quiet[b] >= kSmoothAfter && !pulled);
      places[b] = motions[b].prediction();
      if (body.joint) tree.put_on_parent(b, end, places);
      motions[b].refer_to(places[b].X_WO);
      expected[body.object] = places[b].X_WO;
    }
    contact.begin(poses, expected, stirs);
  }

  /// Whether a body takes part in steps: it does not sleep, and is somewhere.
  [[nodiscard]] bool acts(std::size_t b) const { return !rest.sleeps(b) && !forces.is_nowhere(b); }

  bool roughen() {
    bool any = false;
    for (std::size_t b = 0; b < quiet.size(); ++b) {
      const std::size_t object = tree.bodies()[b].object;
      if (!acts(b) || forces.is_bone(b)) continue;
      if (quiet[b] < kSmoothAfter || !(contact.is_near(object) || is_near(object, partners))) {
        continue;
      }
      quiet[b] = 0;
      any = true;
    }
    if (any) spread_roughness();
    return any;
  }

  /// Whether an object comes into the box in this step.
  [[nodiscard]] bool reaches(const Eigen::AlignedBox3d& box, std::size_t object) const {
    const Eigen::AlignedBox3d own = bounds(objects[object].shape);
    const Vector3 half = 0.5 * own.sizes();
    if (!half.allFinite()) return true;  // endless
    const auto covers = [&](const Pose& X_WO) {
      const Vector3 centre = X_WO * Vector3(own.min() + half);
      const Vector3 extent = X_WO.rotation.cwiseAbs() * half;
      return box.intersects({centre - extent, centre + extent});
    };
    return covers(poses[object]) || covers(expected[object]);
  }

  /// Who hangs together in this step, with these fingers and all that is soft.
  void find_islands(std::span<FingerSimulation* const> stepped) {
    const std::size_t bodies = motions.size();
    islands.begin();
    for (std::size_t b = 0; b < bodies; ++b) {
      if (acts(b)) islands.take(b);
    }
    for (Partner& partner : partners) {
      const bool steps = partner.number < softs.size()
                             ? !sleeps(partner)
                             : std::ranges::find(stepped, partner.finger) != stepped.end();
      takes_part[partner.number] = steps ? 1 : 0;
      if (steps) islands.take(bodies + partner.number);
    }
    for (std::size_t b = 0; b < bodies; ++b) {
      const int parent = tree.bodies()[b].parent;
      if (parent >= 0) islands.join(b, static_cast<std::size_t>(parent));
    }
    contact.for_each_near([&](std::size_t of, std::size_t on) {
      const int a = tree.body_of(of);
      const int b = tree.body_of(on);
      if (a >= 0 && b >= 0) islands.join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    });
    for (const Partner& partner : partners) {
      if (takes_part[partner.number] == 0) continue;
      const std::size_t own = bodies + partner.number;
      for (std::size_t s = 0; s < softs.size(); ++s) {
        // As sleep has it: what is soft wakes what it comes near.
        const bool both_soft =
            partner.number < softs.size() && boxes[own - bodies].intersects(boxes[s]);
        if (both_soft || partner.finger->patches(softs[s]->object()).any()) {
          islands.join(own, bodies + s);
        }
      }
      for (std::size_t b = 0; b < bodies; ++b) {
        const std::size_t object = tree.bodies()[b].object;
        if (!acts(b) || !partner.finger->may_touch(object)) continue;
        if (reaches(boxes[partner.number], object)) islands.join(own, b);
      }
    }
    islands.find();
    std::ranges::fill(island_of_object, -1);
    for (std::size_t b = 0; b < bodies; ++b) {
      island_of_object[tree.bodies()[b].object] = islands.island_of(b);
    }
    contact.share_out(island_of_object, islands.size());
  }

  /// What is to be solved by itself, and how that ended.
  struct Task {
    Island island;
    StepSummary summary;
    long evaluations = 0;
  };

  void make_tasks() {
    const std::size_t bodies = motions.size();
    tasks.clear();
    of_tasks.clear();
    for (std::size_t i = 0; i < islands.size(); ++i) {
      const std::span<const std::size_t> members = islands.members(i);
      const auto first_partner = std::ranges::lower_bound(members, bodies);
      const auto count = static_cast<std::size_t>(first_partner - members.begin());
      Island island{.number = i, .bodies = members.first(count), .partners = {}};
      const std::size_t from = of_tasks.size();
      for (const std::size_t n : members.subspan(count)) {
        of_tasks.push_back(&partners[n - bodies]);
        island.is_soft = island.is_soft || n - bodies < softs.size();
      }
      island.partners = {of_tasks.data() + from, of_tasks.size() - from};
      tasks.push_back({.island = island, .summary = {}});
    }
    for (Partner& partner : partners) {
      if (takes_part[partner.number] == 0) partner.forget();
    }
  }

  void solve(Task& task, IslandProblem& problem, ThreadTeam* helpers) {
    const Island& island = task.island;
    if (island.bodies.empty() && !island.is_soft) {
      island.partners.front()->forget();
      task.summary = island.partners.front()->finger->solve_step();
      return;
    }
    problem.begin(island, time, helpers);
    NewtonOptions options;
    if (island.partners.empty()) options.tolerance = kBodiesTolerance;
    const NewtonSummary summary = minimise_island(problem, options);
    problem.settle();
    problem.end();
    task.summary = {summary.iterations, summary.converged, summary.residual};
    task.evaluations = problem.evaluations() * static_cast<long>(island.bodies.size());
  }

  /// Islands of many fingers one after the other, the work of each shared out; the others side by
  /// side. A finger that is alone may share its own work out, and is not one of these.
  void solve_tasks() {
    shared_tasks.clear();
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const Island& island = tasks[i].island;
      const bool lone = of_tasks.size() == island.partners.size() && !of_tasks.empty();
      if (island.is_soft || island.partners.size() > 1 || lone) {
        solve(tasks[i], *problems.front(), team);
      } else {
        shared_tasks.push_back(i);
      }
    }
    share(team, shared_tasks.size(), [&](std::size_t k, int thread) {
      solve(tasks[shared_tasks[k]], *problems[static_cast<std::size_t>(thread)], nullptr);
    });
    last = {};
    work = {.islands = 0, .sleeping = rest.sleeping(), .near = contact.near_count()};
    near.clear();
    for (const Task& task : tasks) {
      if (task.island.bodies.empty() && !task.island.is_soft) continue;
      ++work.islands;
      work.evaluations += task.evaluations;
      last.iterations = std::max(last.iterations, task.summary.iterations);
      last.converged = last.converged && task.summary.converged;
      last.relative_residual = std::max(last.relative_residual, task.summary.relative_residual);
      for (const Partner* partner : task.island.partners) near.push_back(partner->finger);
    }
  }

  void end() {
    for (const Task& task : tasks) {
      for (const std::size_t b : task.island.bodies) {
        motions[b].end(places[b]);
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

  /// Islands without fingers that have been at rest for long fall asleep.
  void look_for_rest() {
    for (std::size_t b = 0; b < motions.size(); ++b) {
      if (!acts(b)) continue;
      const double reach = forces.reach(b);
      const double speed =
          motions[b].velocity().norm() + reach * motions[b].angular_velocity().norm();
      rest.look(b, motions[b].place().X_WO, reach, speed);
      const bool pulled = forces.pull_on(b) != nullptr;
      const std::size_t object = tree.bodies()[b].object;
      if (pulled || hangs_on_moving(b) || is_near(object, those_of_fingers())) rest.disturb(b);
    }
    for (std::size_t s = 0; s < softs.size(); ++s) {
      if (sleeps_soft(s)) continue;
      if (rest.look(number_of_soft(s), softs[s]->way(), softs[s]->speed())) softs[s]->mark();
      if (is_disturbed(s)) rest.disturb(number_of_soft(s));
    }
    contact.for_each_near([&](std::size_t of, std::size_t on) {
      for (const auto& [o, other] : {std::pair(of, on), std::pair(on, of)}) {
        const int b = tree.body_of(o);
        if (b < 0 || tree.body_of(other) >= 0 || stirs[other] != Stir::kStirs) continue;
        rest.disturb(static_cast<std::size_t>(b));
      }
    });
    for (const Task& task : tasks) {
      const std::span<const std::size_t> members = islands.members(task.island.number);
      const auto rested = [&](std::size_t n) {
        return n < number_of_soft(softs.size()) && rest.has_rested(n);
      };
      if (!task.summary.converged || !std::ranges::all_of(members, rested)) continue;
      rest.fall_asleep(members);
      for (const std::size_t n : members) {
        if (n < motions.size()) {
          motions[n].rest();
        } else {
          softs[n - motions.size()]->simulation().rest();
          tell_soft(n - motions.size());
        }
      }
    }
  }

  void find_overlaps() {
    overlaps.clear();
    overlaps.reserve(kMostOverlaps);
    std::ranges::fill(appeared, std::uint8_t{0});
    std::ranges::fill(stirs, Stir::kStirs);
    contact.begin(poses, poses, stirs);
    contact.for_each_sunk([&](std::size_t of, std::size_t on, double depth) {
      note_overlap({std::min(of, on), std::max(of, on), depth});
    });
  }

  /// What has come into being since the last step, inside something.
  void find_appeared() {
    if (std::ranges::find(appeared, 1) == appeared.end()) return;
    contact.for_each_sunk([&](std::size_t of, std::size_t on, double depth) {
      if (appeared[of] == 0 && appeared[on] == 0) return;
      note_overlap({std::min(of, on), std::max(of, on), depth, time});
    });
    std::ranges::fill(appeared, std::uint8_t{0});
  }

  void note_overlap(const Overlap& found) {
    const auto known = std::ranges::find_if(overlaps, [&](const Overlap& overlap) {
      return overlap.first == found.first && overlap.second == found.second &&
             overlap.time == found.time;
    });
    if (known != overlaps.end()) {
      known->depth = std::max(known->depth, found.depth);
    } else if (overlaps.size() < kMostOverlaps) {
      overlaps.push_back(found);
    }
  }

  void prepare_events() {
    std::vector<int> moving;
    std::vector<WorldEvents::Joint> joints;
    for (const auto& soft : softs) moving.push_back(static_cast<int>(soft->object()));
    for (std::size_t b = 0; b < motions.size(); ++b) {
      const Body& body = tree.bodies()[b];
      moving.push_back(static_cast<int>(body.object));
      const JointLaw* const law = forces.law(b);
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
    for (std::size_t b = 0; b < motions.size(); ++b) {
      if (rest.sleeps(b)) events->lie(static_cast<int>(tree.bodies()[b].object));
    }
    for (std::size_t s = 0; s < softs.size(); ++s) {
      if (sleeps_soft(s)) events->lie(static_cast<int>(softs[s]->object()));
    }
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
    for (std::size_t s = 0; s < softs.size(); ++s) {
      if (sleeps_soft(s)) continue;
      const auto& soft = softs[s];
      for (std::size_t o = 0; o < objects.size(); ++o) {
        events->touch(static_cast<int>(soft->object()), static_cast<int>(o),
                      soft->simulation().potential().contact().wrench(o).normal_force);
      }
    }
    std::size_t joint = 0;
    for (std::size_t b = 0; b < motions.size(); ++b) {
      const JointLaw* const law = forces.law(b);
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
      if (!acts(b)) continue;
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
  BodyForces forces;
  SoftContact soft_contact;
  BodyRest rest;
  std::vector<BodyMotion> motions;
  std::vector<BodyPlace> places;
  std::vector<Pose> poses, expected;  ///< of objects, at the start of the step and at its end
  std::vector<ObjectState> states;
  std::vector<Stir> stirs;            ///< by object
  std::vector<int> island_of_object;  ///< -1: none
  std::vector<int> quiet;             ///< by body: steps without contact
  std::vector<std::unique_ptr<SoftBody>> softs;
  std::vector<std::uint8_t> has_begun;                   ///< by soft object: its step
  std::vector<Partner> partners;                         ///< what is soft, then the fingers
  std::vector<std::unique_ptr<IslandProblem>> problems;  ///< by thread
  std::vector<FingerSimulation*> fingers, near;
  std::vector<Eigen::AlignedBox3d> boxes;  ///< about each partner
  std::vector<std::uint8_t> takes_part;    ///< by partner
  Islands islands;
  std::vector<Task> tasks;  ///< an island each
  std::vector<std::size_t> shared_tasks;
  std::vector<Partner*> of_tasks;
  double time = 0.0;
  std::optional<WorldEvents> events;
  std::vector<Overlap> overlaps;
  std::vector<std::uint8_t> appeared;  ///< by object: a bone, since the last step
  StepSummary last;
  StepWork work;
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
