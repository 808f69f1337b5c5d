#include "softfinger/world/solid_contact.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace softfinger {
namespace {

/// A point is looked at where it is this near, and twice as near as objects are expected to move,
/// m.
constexpr double kNear = 1e-3;
/// Tangential stiffness as a part of the normal one.
constexpr double kTangentialRatio = 0.3;
/// Friction may be beyond the cone by this part, and this force (N).
constexpr double kConeRelative = 1e-3;
constexpr double kConeAbsolute = 1e-7;
/// What is left of a limit of what came off within a step, N.
constexpr double kLeastLimit = 1e-12;
/// A limit that only falls goes no further below the cone than this part of it.
constexpr double kMostBelow = 0.1;
/// More are never in reach of each other at once; the nearest of later ones are left out.
constexpr std::size_t kMostCandidates = 16384;

/// Corners of a box at a pose.
Eigen::AlignedBox3d moved(const Eigen::AlignedBox3d& box, const Pose& X) {
  const Vector3 half = 0.5 * box.sizes();
  if (!half.allFinite()) return box;
  const Vector3 centre = X * Vector3(box.min() + half);
  const Vector3 extent = X.rotation.cwiseAbs() * half;
  return {centre - extent, centre + extent};
}

/// Of what leans this much the rim's deepest place alone touches, as a sine; what stands on its rim
/// has none.
constexpr double kLeaning = 0.2;
/// Spacings of a rim's points from the deepest place: nearer than that they would bear what is a
/// micrometre deep.
constexpr double kStays = 2.0;
/// What bears less of the stiffness is left out.
constexpr double kLeastShare = 1e-6;

struct Place {
  Vector3 centre_O = Vector3::Zero();
  double share = 1.0;  ///< of the stiffness
};

/// Where a point is looked at while the way out of the other object is `outward`, in the frame of
/// its own: of a rim the two points next to the deepest place go there and share what it bears, and
/// those further from it stay, to touch where the object turns far within the step.
Place place_of(const SurfacePoint& point, const Vector3& outward) {
  const double lean = outward.head<2>().norm();
  if (!(point.spacing > 0.0) || !(lean > 0.0)) return {point.centre_O};
  const double deepest = std::atan2(-outward.y(), -outward.x());
  const double way = std::remainder(deepest - std::atan2(point.centre_O.y(), point.centre_O.x()),
                                    2.0 * std::numbers::pi);
  const double leaning = std::min(1.0, lean * lean / (kLeaning * kLeaning));
  if (leaning == 1.0 && std::abs(way) > kStays * point.spacing) return {point.centre_O};
  const double near = std::max(0.0, 1.0 - std::abs(way) / point.spacing);
  const double turn = leaning * std::clamp(way, -point.spacing, point.spacing);
  return {Eigen::AngleAxisd(turn, Vector3::UnitZ()) * point.centre_O, 1.0 - leaning * (1.0 - near)};
}

}  // namespace

SolidContact::SolidContact(std::span<const VirtualObject> objects, std::span<const double> masses,
                           std::span<const std::array<int, 2>> apart, double time_step)
    : objects_(objects),
      parting_(kParting * time_step),
      near_(objects.size(), 0),
      touched_(objects.size(), 0.0) {
  for (std::size_t o = 0; o < objects.size(); ++o) {
    points_.push_back(surface_points(objects[o].shape));
    bounds_.push_back(bounds(objects[o].shape));
    memories_.emplace_back(points_.back().size());
    moves_.push_back(masses[o] > 0.0 ? 1 : 0);
  }
  remembered_.assign(objects.size(), 0);
  const auto are_apart = [&](std::size_t a, std::size_t b) {
    return std::ranges::any_of(apart, [&](const std::array<int, 2>& pair) {
      const auto x = static_cast<std::size_t>(pair[0]);
      const auto y = static_cast<std::size_t>(pair[1]);
      return (x == a && y == b) || (x == b && y == a);
    });
  };
  // The heaviest one may come to rest on any other.
  double heaviest = 0.0;
  for (std::size_t o = 0; o < objects.size(); ++o) {
    if (objects[o].hand() < 0) heaviest = std::max(heaviest, masses[o]);
  }
  const double stiffness =
      std::max(kStiffness * heaviest / (time_step * time_step), kLeastForce / kDepth);
  for (std::size_t a = 0; a < objects.size(); ++a) {
    for (std::size_t b = a + 1; b < objects.size(); ++b) {
      if (!(masses[a] > 0.0 || masses[b] > 0.0) || are_apart(a, b)) continue;
      if (objects[a].soft || objects[b].soft) continue;  // they meet as skin meets objects
      const double friction = friction_between(objects[a], objects[b]);
      if (objects[a].hand() >= 0 || objects[b].hand() >= 0) {
        add_hand_pairs(a, b, friction, stiffness);
        continue;
      }
      const bool both = !points_[a].empty() && !points_[b].empty();
      const double share = both ? 0.5 : 1.0;
      if (!points_[a].empty()) pairs_.push_back({a, b, share * stiffness, friction});
      if (!points_[b].empty()) pairs_.push_back({b, a, share * stiffness, friction});
    }
  }
  std::size_t most = 0;
  for (const Pair& pair : pairs_) most += points_[pair.of].size();
  candidates_.resize(std::min(most, kMostCandidates));
  shared_.reserve(candidates_.size());
}

void SolidContact::add_hand_pairs(std::size_t a, std::size_t b, double friction, double stiffness) {
  const int hand = objects_[a].hand();
  const int other = objects_[b].hand();
  if (hand == other) return;
  const double share = hand >= 0 && other >= 0 ? 0.5 : 1.0;
  const auto add = [&](std::size_t of, std::size_t on) {
    if (objects_[of].hand() < 0) return;
    const double foundation = share * objects_[of].dynamics->following->foundation;
    pairs_.push_back({of, on, share * stiffness, friction, foundation});
  };
  add(a, b);
  add(b, a);
}

void SolidContact::reset() {
  for (auto& of : memories_) {
    for (auto& point : of) point.fill(Memory{});
  }
  candidate_count_ = 0;
  std::ranges::fill(touched_, 0.0);
  std::ranges::fill(remembered_, std::size_t{0});
}

void SolidContact::forget(std::size_t object) {
  for (std::size_t of = 0; of < memories_.size(); ++of) {
    if (remembered_[of] == 0) continue;
    for (std::array<Memory, kPartners>& point : memories_[of]) {
      for (Memory& memory : point) {
        const bool known = of == object ? memory.on >= 0 : memory.on == static_cast<int>(object);
        if (known) forget(of, memory);
      }
    }
  }
}

void SolidContact::forget(std::size_t of, Memory& memory) {
  memory = Memory{};
  --remembered_[of];
}

SolidContact::Memory* SolidContact::memory_of(std::size_t of, std::size_t point, std::size_t on) {
  for (Memory& memory : memories_[of][point]) {
    if (memory.on == static_cast<int>(on)) return &memory;
  }
  return nullptr;
}

void SolidContact::begin(std::span<const Pose> X_WO, std::span<const Pose> X_WO_expected,
                         std::span<const Motion> motions) {
  candidate_count_ = 0;
  std::ranges::fill(near_, std::uint8_t{0});
  for (std::size_t o = 0; o < motions.size(); ++o) {
    if (motions[o] != Motion::kLies) touched_[o] = 0.0;
  }
  for (const Pair& pair : pairs_) {
    const Motion of = motions[pair.of];
    const Motion on = motions[pair.on];
    if (of == Motion::kAbsent || on == Motion::kAbsent) continue;
    if (of == Motion::kStirs || on == Motion::kStirs) add_candidates(pair, X_WO, X_WO_expected);
  }
}

void SolidContact::share_out(std::span<const int> island_of_object, std::size_t islands) {
  const auto island_of = [&](const Candidate& c) {
    const int island = std::max(island_of_object[c.of], island_of_object[c.on]);
    return static_cast<std::size_t>(island);
  };
  starts_.assign(islands + 1, 0);
  shared_.resize(candidate_count_);
  for (std::size_t k = 0; k < candidate_count_; ++k) ++starts_[island_of(candidates_[k])];
  for (std::size_t i = 1; i <= islands; ++i) starts_[i] += starts_[i - 1];
  // From the ends, so that each keeps its order.
  for (std::size_t k = candidate_count_; k-- > 0;) {
    shared_[--starts_[island_of(candidates_[k])]] = k;
  }
}

void SolidContact::add_candidates(const Pair& pair, std::span<const Pose> X_WO,
                                  std::span<const Pose> X_WO_expected) {
  const auto way = [&](std::size_t o) {
    return (X_WO_expected[o].translation - X_WO[o].translation).norm() +
           bounds_[o].diagonal().norm() * (X_WO_expected[o].rotation - X_WO[o].rotation).norm();
  };
  double reach = kNear;
  for (const std::size_t o : {pair.of, pair.on}) {
    if (bounds_[o].diagonal().allFinite()) reach += 2.0 * way(o);
  }
  const Pose X_OW = X_WO[pair.on].inverse();
  const Pose X_on_of = X_OW * X_WO[pair.of];
  const Matrix3 expected =
      X_WO_expected[pair.on].rotation.transpose() * X_WO_expected[pair.of].rotation;
  Eigen::AlignedBox3d near = bounds_[pair.on];
  near.min().array() -= reach;
  near.max().array() += reach;
  if (!near.intersects(moved(bounds_[pair.of], X_on_of))) return;
  const Shape& shape = objects_[pair.on].shape;
  for (std::size_t i = 0; i < points_[pair.of].size(); ++i) {
    const SurfacePoint& point = points_[pair.of][i];
    Vector3 centre_on = X_on_of * point.centre_O;
    if (near.exteriorDistance(centre_on) > point.radius) continue;
    SignedDistance at = distance_and_gradient(shape, centre_on);
    Memory* const memory = memory_of(pair.of, i, pair.on);
    Place place{point.centre_O};
    if (point.spacing > 0.0) {
      place = place_of(point, expected.transpose() * at.gradient);
      if (place.share < kLeastShare) {
        if (memory != nullptr) forget(pair.of, *memory);
        continue;
      }
      centre_on = X_on_of * place.centre_O;
      at = distance_and_gradient(shape, centre_on);
    }
    if (at.distance - point.radius > reach && memory == nullptr) continue;
    if (candidate_count_ == candidates_.size()) return;
    near_[pair.of] = near_[pair.on] = 1;
    Candidate& c = candidates_[candidate_count_++];
    c = Candidate{.of = pair.of,
                  .on = pair.on,
                  .point = i,
                  .centre_O = place.centre_O,
                  .stiffness = place.share * pair.stiffness,
                  .friction_coefficient = pair.friction_coefficient,
                  .allowed = std::min(0.0, at.distance - point.radius + parting_)};
    if (pair.foundation > 0.0) {
      // Flesh that is pressed in has touched first; what was inside before it parts as rigid things
      // do, for flesh as deep as that would throw it out.
      c.began_inside = c.allowed < 0.0 && (memory == nullptr || memory->began_inside);
      if (!c.began_inside) {
        c.stiffness = pair.foundation * point.area;
        c.allowed = 0.0;
      }
    }
    const Vector3 surface_on = centre_on - point.radius * at.gradient;
    c.material_of = X_on_of.inverse() * surface_on;
    c.free_on = surface_on;
    c.normal_on = at.gradient;
    if (memory == nullptr) continue;
    c.limit = memory->limit;
    // Slip lies in the surface, which may have turned.
    Vector3 slip = memory->slip_O - at.gradient * at.gradient.dot(memory->slip_O);
    const double length = slip.norm();
    if (length > 0.0) slip *= std::min(1.0, memory->slip_O.norm() / length);
    c.free_on -= slip;
  }
}

double SolidContact::friction_stiffness(const Candidate& c) const {
  return kTangentialRatio * c.stiffness;
}

double SolidContact::evaluate(Candidate& c, std::span<const Pose> X_WO) const {
  const Pose& X_of = X_WO[c.of];
  const Pose& X_on = X_WO[c.on];
  const SurfacePoint& point = points_[c.of][c.point];
  c.centre_W = X_of * c.centre_O;
  const SignedDistance at =
      distance_and_gradient(objects_[c.on].shape, X_on.inverse() * c.centre_W);
  c.gap = at.distance - point.radius - c.allowed;
  c.normal = X_on.rotation * at.gradient;
  c.pressing = 0.0;
  c.friction_force.setZero();
  double energy = 0.0;
  if (c.gap < 0.0) {
    c.pressing = -c.stiffness * c.gap;
    c.normal_stiffness = c.stiffness * c.normal * c.normal.transpose();
    energy += 0.5 * c.stiffness * c.gap * c.gap;
  }
  if (!(c.limit > 0.0)) return energy;
  c.material_W = X_of * c.material_of;
  const Vector3 n = X_on.rotation * c.normal_on;
  const Vector3 way = c.material_W - X_on * c.free_on;
  c.slip = way - n * n.dot(way);
  const double k = friction_stiffness(c);
  const double length = c.slip.norm();
  const Matrix3 tangent = Matrix3::Identity() - n * n.transpose();
  if (k * length <= c.limit) {
    c.friction_force = -k * c.slip;
    c.friction_stiffness = k * tangent;
    return energy + 0.5 * k * length * length;
  }
  const Vector3 along = c.slip / length;
  c.friction_force = -c.limit * along;
  c.friction_stiffness = c.limit / length * (tangent - along * along.transpose());
  return energy + c.limit * (length - 0.5 * c.limit / k);
}

SolidContact::Sum SolidContact::evaluate(std::size_t island, std::span<const Pose> X_WO,
                                         std::span<Vector6> wrenches) {
  Sum sum;
  // What forces do not move may be touched by several islands, on as many threads.
  const std::span<const std::size_t> all = of_island(island);
  for (const std::size_t k : all) {
    for (const std::size_t o : {candidates_[k].of, candidates_[k].on}) {
      if (moves_[o] != 0) touched_[o] = 0.0;
    }
  }
  const auto add = [&](const Candidate& c, const Vector3& at, const Vector3& force) {
    for (const std::size_t o : {c.of, c.on}) {
      if (moves_[o] == 0) continue;
      const double sign = o == c.of ? -1.0 : 1.0;
      const Vector3 arm = at - X_WO[o].translation;
      wrenches[o].head<3>() += sign * force;
      wrenches[o].tail<3>() += sign * arm.cross(force);
    }
    sum.squared_force += force.squaredNorm();
  };
  for (const std::size_t k : all) {
    Candidate& c = candidates_[k];
    sum.energy += evaluate(c, X_WO);
    if (c.pressing > 0.0) {
      for (const std::size_t o : {c.of, c.on}) {
        if (moves_[o] != 0) touched_[o] += c.stiffness;
      }
      add(c, c.centre_W, c.pressing * c.normal);
    }
    if (c.limit > 0.0) add(c, c.material_W, c.friction_force);
  }
  return sum;
}

bool SolidContact::is_in_cone(std::size_t island) const {
  return std::ranges::all_of(of_island(island), [&](std::size_t k) {
    const Candidate& c = candidates_[k];
    const double limit = c.friction_coefficient * c.pressing;
    return c.friction_force.norm() <= (1.0 + kConeRelative) * limit + kConeAbsolute;
  });
}

double SolidContact::beyond_cone(std::size_t island) const {
  double sum = 0.0;
  for (const std::size_t k : of_island(island)) {
    const Candidate& c = candidates_[k];
    if (!(c.limit > 0.0)) continue;
    sum += std::max(0.0, c.friction_force.norm() - c.friction_coefficient * c.pressing);
  }
  return sum;
}

void SolidContact::update_limits(std::size_t island, bool only_lower, double overshoot) {
  for (const std::size_t k : of_island(island)) {
    Candidate& c = candidates_[k];
    double limit = c.friction_coefficient * c.pressing;
    if (only_lower && limit >= c.limit) continue;
    if (only_lower) limit -= std::min(overshoot * (c.limit - limit), kMostBelow * limit);
    c.limit = std::max(limit, c.limit > 0.0 ? kLeastLimit : 0.0);
  }
}

void SolidContact::add_turn_half_way(std::span<const Pose> X_WO_start, std::span<const Pose> X_WO,
                                     std::span<const Vector3> pivots_O,
                                     std::span<Vector3> moments) const {
  for (std::size_t k = 0; k < candidate_count_; ++k) {
    const Candidate& c = candidates_[k];
    if (!(c.limit > 0.0)) continue;
    const auto add = [&](std::size_t o, const Vector3& point_O, const Vector3& force) {
      const Vector3 passed = (X_WO[o].rotation - X_WO_start[o].rotation) * (point_O - pivots_O[o]);
      moments[o] -= 0.5 * passed.cross(force);
    };
    if (moves_[c.of] != 0) add(c.of, c.material_of, c.friction_force);
    if (moves_[c.on] != 0) add(c.on, X_WO[c.on].inverse() * c.material_W, -c.friction_force);
  }
}

void SolidContact::end(std::span<const Pose> X_WO) {
  for (std::size_t k = 0; k < candidate_count_; ++k) {
    const Candidate& c = candidates_[k];
    Memory* memory = memory_of(c.of, c.point, c.on);
    if (!(c.pressing > 0.0)) {
      if (memory != nullptr) forget(c.of, *memory);
      continue;
    }
    if (memory == nullptr) {
      for (Memory& free : memories_[c.of][c.point]) {
        if (free.on < 0) memory = &free;
      }
    }
    if (memory == nullptr) continue;
    if (memory->on < 0) ++remembered_[c.of];
    memory->on = static_cast<int>(c.on);
    memory->normal_O = X_WO[c.on].rotation.transpose() * c.normal;
    const double limit = c.friction_coefficient * c.pressing;
    Vector3 slip = Vector3::Zero();
    if (c.limit > 0.0) {
      slip = c.slip;
      const double longest = std::min(limit, c.limit) / friction_stiffness(c);
      if (slip.norm() > longest) slip *= longest / slip.norm();
    }
    memory->slip_O = X_WO[c.on].rotation.transpose() * slip;
    memory->limit = limit;
    memory->began_inside = c.began_inside;
  }
}

double SolidContact::normal_force(std::size_t a, std::size_t b) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < candidate_count_; ++k) {
    const Candidate& c = candidates_[k];
    if ((c.of == a && c.on == b) || (c.of == b && c.on == a)) sum += c.pressing;
  }
  return sum;
}

}  // namespace softfinger
