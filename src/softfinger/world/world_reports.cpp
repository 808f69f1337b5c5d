// What overlaps, and what happens: impacts, releases, clicks.
#include <algorithm>

#include "softfinger/finger/finger_potential.hpp"
#include "softfinger/world/world_implementation.hpp"

namespace softfinger {

void World::Implementation::find_overlaps() {
  overlaps.clear();
  overlaps.reserve(kMostOverlaps);
  std::ranges::fill(appeared, std::uint8_t{0});
  std::ranges::fill(stirs, Stir::kStirs);
  contact.begin(poses, poses, stirs);
  contact.for_each_sunk([&](std::size_t of, std::size_t on, double depth) {
    note_overlap({std::min(of, on), std::max(of, on), depth});
  });
}

void World::Implementation::find_appeared() {
  if (std::ranges::find(appeared, 1) == appeared.end()) return;
  contact.for_each_sunk([&](std::size_t of, std::size_t on, double depth) {
    if (appeared[of] == 0 && appeared[on] == 0) return;
    note_overlap({std::min(of, on), std::max(of, on), depth, time});
  });
  std::ranges::fill(appeared, std::uint8_t{0});
}

void World::Implementation::note_overlap(const Overlap& found) {
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

void World::Implementation::prepare_events() {
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

void World::Implementation::tell_events() {
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
    events->joint(joint++, {.q = q, .limit_force = law->limit_force(q), .detent = law->detent(q)});
  }
  events->end_step();
}

}  // namespace softfinger
