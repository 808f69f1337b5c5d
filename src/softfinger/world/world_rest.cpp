// What falls asleep, and what moves without contact for long enough to count as smooth.
#include <algorithm>

#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/world/world_implementation.hpp"

namespace softfinger {

bool World::Implementation::roughen() {
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

void World::Implementation::look_for_rest() {
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

void World::Implementation::count_quiet() {
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

void World::Implementation::spread_roughness() {
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

}  // namespace softfinger
