// Where all is expected at a step's end, who is near whom then, and what that wakes.
#include <algorithm>

#include "softfinger/world/world_implementation.hpp"

namespace softfinger {
namespace {

/// A finger this near to an object that moves takes part in its step, m.
constexpr double kTakesPart = 5e-3;

/// What a finger could touch, W.
Eigen::AlignedBox3d box_around(const FingerSimulation& finger) {
  Eigen::AlignedBox3d box;
  for (const Vector3& p : finger.positions()) box.extend(p);
  box.min().array() -= kTakesPart;
  box.max().array() += kTakesPart;
  return box;
}

}  // namespace

void World::Implementation::expect(double end) {
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

bool World::Implementation::hangs_on_moving(std::size_t b) const {
  const Body& body = tree.bodies()[b];
  if (!body.joint || body.joint->parent < 0 || body.parent >= 0) return false;
  return stirs[static_cast<std::size_t>(body.joint->parent)] == Stir::kStirs;
}

void World::Implementation::put_boxes() {
  for (std::size_t p = 0; p < partners.size(); ++p) boxes[p] = box_around(*partners[p].finger);
}

std::span<const Partner> World::Implementation::those_of_fingers() const {
  return std::span(partners).subspan(softs.size());
}

bool World::Implementation::is_near(std::size_t object, std::span<const Partner> some) const {
  return std::ranges::any_of(some, [&](const Partner& partner) {
    return !sleeps(partner) && partner.finger->may_touch(object) &&
           reaches(boxes[partner.number], object);
  });
}

bool World::Implementation::is_disturbed(std::size_t s) const {
  if (stirs[softs[s]->object()] == Stir::kStirs) return true;
  for (const Partner& partner : those_of_fingers()) {
    if (boxes[s].intersects(boxes[partner.number])) return true;
  }
  for (std::size_t o = 0; o < objects.size(); ++o) {
    if (tree.body_of(o) < 0 && stirs_near(s, o)) return true;
  }
  return false;
}

bool World::Implementation::stirs_near(std::size_t s, std::size_t object) const {
  return stirs[object] == Stir::kStirs && objects[object].soft == nullptr &&
         reaches(boxes[s], object);
}

bool World::Implementation::is_met(std::size_t s) const {
  if (is_disturbed(s)) return true;
  for (std::size_t other = 0; other < softs.size(); ++other) {
    if (!sleeps_soft(other) && boxes[s].intersects(boxes[other])) return true;
  }
  return std::ranges::any_of(tree.bodies(),
                             [&](const Body& body) { return stirs_near(s, body.object); });
}

bool World::Implementation::wake_near_partners() {
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

void World::Implementation::predict_awake(double end) {
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

void World::Implementation::predict(double end) {
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

bool World::Implementation::reaches(const Eigen::AlignedBox3d& box, std::size_t object) const {
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

}  // namespace softfinger
