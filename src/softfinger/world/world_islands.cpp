// Who hangs together in a step; each island is solved by itself.
#include <algorithm>

#include "softfinger/contact/surface_patches.hpp"
#include "softfinger/threads/thread_team.hpp"
#include "softfinger/world/minimise_island.hpp"
#include "softfinger/world/world_implementation.hpp"

namespace softfinger {
namespace {

/// Residual of an island without fingers, whose matrix is exact.
constexpr double kBodiesTolerance = 1e-10;

}  // namespace

void World::Implementation::find_islands(std::span<FingerSimulation* const> stepped) {
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

void World::Implementation::make_tasks() {
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

void World::Implementation::solve(Task& task, IslandProblem& problem, ThreadTeam* helpers) {
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

void World::Implementation::solve_tasks() {
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

}  // namespace softfinger
