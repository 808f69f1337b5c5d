#include "softfinger/finger/feature_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/contact/deepest_point.hpp"

namespace softfinger {
namespace {

/// A triangle is searched where an obstacle comes nearer to its inside than to the mean of its
/// corners by more than this, m: what is flat to that accuracy the samples meet.
constexpr double kBulge = 3e-5;
/// Or where the corners' normals say that it could by more than this: a point at a corner.
constexpr double kSharp = 1e-4;
/// A point further from the obstacle than this is left out, m: one may come as near within a step
/// when skin that was balanced on an edge slips off.
constexpr double kWithin = 1e-4;
/// A side of an obstacle is met by a triangle where their normals are not further apart than this:
/// cosine of the angle.
constexpr double kFacing = 0.5;
/// No point of a triangle is further from a corner than this, of its longest edge.
constexpr double kFarthest = 0.58;
/// Part of the way to the deepest point that a known one goes in a step: all of it, and the skin,
/// which tilts as it is pressed elsewhere, would answer by going back and forth. Where it does so
/// all the same, less and less; more again where the way goes on.
constexpr double kFollow = 0.3;
constexpr double kTurned = 0.7;
constexpr double kGoesOn = 1.2;

/// How much deeper than the mean of its corners a convex solid can be inside a triangle: with the
/// weights w, its gap is above the mean by w of the corners' tangent planes, and the sum of w_k w_j
/// over the three pairs is at most 1/3.
double deepest_bulge(const std::array<Vector3, 3>& corners,
                     const std::array<SignedDistance, 3>& at) {
  double turn = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    turn = std::max(turn, (at[next].gradient - at[k].gradient).dot(corners[next] - corners[k]));
  }
  return turn / 3.0;
}

}  // namespace

FeaturePoints::FeaturePoints(const FingerModel& model, std::size_t obstacle_count)
    : model_(model),
      place_(model.skin_triangles.size() * obstacle_count, -1),
      obstacle_count_(obstacle_count) {
  for (const auto& triangle : model.skin_triangles) {
    is_free_.push_back(std::ranges::none_of(triangle, [&](int sample) {
      const int node = model.sample_nodes[static_cast<std::size_t>(sample)];
      return model.node_is_rigid[static_cast<std::size_t>(node)];
    }));
  }
  corners_.resize(model.sample_nodes.size());
}

void FeaturePoints::place_corners(const Step& step, const ContactPotential& contact,
                                  std::size_t o) {
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const auto node = static_cast<std::size_t>(model_.sample_nodes[i]);
    corners_[i].position_O = contact.obstacle_view(o) * step.positions[node];
    corners_[i].bound = contact.gap_bound(i, o, corners_[i].position_O);
    corners_[i].known = false;
  }
}

ContactSide FeaturePoints::side_of_triangle(const ContactPotential& contact, std::size_t t,
                                            std::size_t o) const {
  ContactSide side;
  double least = std::numeric_limits<double>::infinity();
  for (const int sample : model_.skin_triangles[t]) {
    const auto i = static_cast<std::size_t>(sample);
    const ContactSide& own = contact.side(i, o);
    if (!own.known || corners_[i].at.distance >= least) continue;
    least = corners_[i].at.distance;
    side = own;
  }
  return side;
}

ContactSide FeaturePoints::side_on_way_of(const Step& step, const ContactPotential& contact,
                                          std::size_t t, std::size_t o,
                                          const std::array<double, 3>& weights) const {
  Vector3 from = Vector3::Zero();
  Vector3 to = Vector3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(model_.skin_triangles[t][k]);
    const auto node = static_cast<std::size_t>(model_.sample_nodes[i]);
    from += weights[k] * (contact.old_obstacle_view(o) * step.old_positions[node]);
    to += weights[k] * corners_[i].position_O;
  }
  const Shape& shape = *step.obstacles[o].shape;
  if (!may_have_passed(shape, from, to, distance_and_gradient(shape, to))) return {};
  return side_on_way(shape, from, to);
}

FeaturePoints::Found FeaturePoints::find(const Step& step, const ContactPotential& contact,
                                         std::size_t t, std::size_t o, const Point* known) {
  Found found;
  std::array<Vector3, 3> corners;
  double bound = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Corner& corner = corners_[static_cast<std::size_t>(model_.skin_triangles[t][k])];
    corners[k] = corner.position_O;
    bound = std::min(bound, corner.bound);
  }
  const double longest_squared =
      std::max({(corners[1] - corners[0]).squaredNorm(), (corners[2] - corners[1]).squaredNorm(),
                (corners[0] - corners[2]).squaredNorm()});
  if (bound > 0.0 && bound * bound > kFarthest * kFarthest * longest_squared) return found;
  const Vector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (!(normal.squaredNorm() > 0.0)) return found;
  const Vector3 offset_O = -kDepth * normal.normalized();

  const Shape& shape = *step.obstacles[o].shape;
  std::array<SignedDistance, 3> at;
  for (std::size_t k = 0; k < 3; ++k) {
    Corner& corner = corners_[static_cast<std::size_t>(model_.skin_triangles[t][k])];
    if (!corner.known) {
      const auto sample = static_cast<std::size_t>(model_.skin_triangles[t][k]);
      corner.at = contact.look(sample, o, corner.position_O);
    }
    corner.known = true;
    at[k] = corner.at;
  }
  const double least = std::min({at[0].distance, at[1].distance, at[2].distance});
  const double bulge = deepest_bulge(corners, at);
  if (!std::holds_alternative<MeshShape>(shape) && least - bulge > kWithin - kDepth) return found;
  ContactSide side = known != nullptr ? known->side : side_of_triangle(contact, t, o);
  TrianglePoint start = least_of_few(shape, side, corners);
  if (known != nullptr) {
    start.weights = known->weights;
  } else {
    double affine = 0.0;
    for (std::size_t k = 0; k < 3; ++k) affine += start.weights[k] * at[k].distance;
    if (start.gap > affine - kBulge && bulge < kSharp) return found;
    for (std::size_t k = 0; k < 3; ++k) {
      if (at[k].distance >= start.gap) continue;
      start = {{}, at[k].distance};
      start.weights[k] = 1.0;
    }
  }
  if (!side.known) side = side_on_way_of(step, contact, t, o, start.weights);
  // Of a blade it is the edge that is met, not its flanks.
  side.known = side.known && side.normal_O.dot(offset_O) > kFacing * kDepth;
  for (Vector3& corner : corners) corner += offset_O;
  const TrianglePoint point = deepest_point(shape, side, corners, start);
  found.weights = point.weights;
  const Pose& X_OW = contact.obstacle_view(o);
  const Matrix3 R_WO = X_OW.rotation.transpose();
  found.offset = R_WO * offset_O;
  const Vector3 p_O = point_at(corners, point.weights);
  // At the deepest point the surface is parallel to the triangle, and a little beside it, as the
  // point is that follows, a sharp feature's is not: the skin's normal counts.
  found.plane = {.obstacle = static_cast<int>(o), .normal = found.offset / kDepth, .offset = 0.0};
  const Vector3 p_W = R_WO * (p_O - X_OW.translation);
  found.plane.offset = point.gap - found.plane.normal.dot(p_W);
  found.known = true;
  found.near = point.gap < kWithin;
  if (found.near) {
    const DistanceFromSide seen = distance_from_side(shape, side, p_O);
    found.side = seen.behind ? side_above(shape, side, p_O) : side_at(seen.at, p_O);
  }
  return found;
}

void FeaturePoints::move(const Step& step, const ContactPotential& contact, std::size_t k,
                         const Found& found, std::span<FrictionAnchor> anchors) {
  Point& point = points_[k];
  const Vector3 before = position(point, step.old_positions);
  double along = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double way = found.weights[c] - point.weights[c];
    along += way * point.way[c];
    point.way[c] = way;
  }
  point.follow *= along < 0.0 ? kTurned : kGoesOn;
  point.follow = std::min(point.follow, kFollow);
  for (std::size_t c = 0; c < 3; ++c) point.weights[c] += point.follow * point.way[c];
  point.offset = found.offset;
  point.plane = found.plane;
  point.side = found.side;
  point.near = found.near;
  // Friction goes on from where it was: another point of the skin, as far from its anchor.
  const Vector3 shift = position(point, step.old_positions) - before;
  for (std::size_t o = 0; o < step.obstacles.size(); ++o) {
    FrictionAnchor& anchor = anchors[k * step.obstacles.size() + o];
    if (anchor.limit > 0.0) anchor.anchor_O += contact.old_obstacle_view(o).rotation * shift;
  }
}

void FeaturePoints::clear() {
  count_ = 0;
  std::fill(place_.begin(), place_.end(), -1);
}

void FeaturePoints::keep(State& state) const {
  std::copy_n(points_.begin(), count_, state.points.begin());
  state.count = count_;
}

bool FeaturePoints::restore(const State& state) {
  bool same = count_ == state.count;
  for (std::size_t k = 0; k < count_; ++k) {
    const Point& point = points_[k];
    same = same && point.triangle == state.points[k].triangle &&
           point.obstacle == state.points[k].obstacle;
    place_[static_cast<std::size_t>(point.triangle) * obstacle_count_ +
           static_cast<std::size_t>(point.obstacle)] = -1;
  }
  std::copy_n(state.points.begin(), state.count, points_.begin());
  count_ = state.count;
  for (std::size_t k = 0; k < count_; ++k) {
    place_[static_cast<std::size_t>(points_[k].triangle) * obstacle_count_ +
           static_cast<std::size_t>(points_[k].obstacle)] = static_cast<int>(k);
  }
  return same;
}

void FeaturePoints::release_last(const ContactCorrection& correction) {
  const std::size_t samples = model_.sample_nodes.size();
  while (count_ > 0 && !points_[count_ - 1].near && !correction.holds(samples + count_ - 1)) {
    const Point& last = points_[--count_];
    place_[static_cast<std::size_t>(last.triangle) * obstacle_count_ +
           static_cast<std::size_t>(last.obstacle)] = -1;
  }
}

std::size_t FeaturePoints::free_place(const ContactCorrection& correction) const {
  const std::size_t samples = model_.sample_nodes.size();
  std::size_t k = 0;
  while (k < count_ && (points_[k].near || correction.holds(samples + k))) ++k;
  return k;
}

void FeaturePoints::put(std::size_t k, std::size_t t, std::size_t o, const Found& found,
                        std::span<FrictionAnchor> anchors) {
  Point& point = points_[k];
  if (k < count_) {
    place_[static_cast<std::size_t>(point.triangle) * obstacle_count_ +
           static_cast<std::size_t>(point.obstacle)] = -1;
  }
  count_ = std::max(count_, k + 1);
  place_[t * obstacle_count_ + o] = static_cast<int>(k);
  point.triangle = static_cast<int>(t);
  point.obstacle = static_cast<int>(o);
  point.weights = found.weights;
  point.way = {};
  point.follow = kFollow;
  point.offset = found.offset;
  point.plane = found.plane;
  point.side = found.side;
  point.near = true;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto sample = static_cast<std::size_t>(model_.skin_triangles[t][c]);
    point.samples[c] = model_.skin_triangles[t][c];
    point.nodes[c] = model_.sample_nodes[sample];
  }
  for (std::size_t other = 0; other < obstacle_count_; ++other) {
    anchors[k * obstacle_count_ + other] = FrictionAnchor{};
  }
}

void FeaturePoints::choose(const Step& step, const ContactPotential& contact,
                           const ContactCorrection& correction, std::span<FrictionAnchor> anchors) {
  release_last(correction);
  for (Point& point : std::span(points_.data(), count_)) {
    point.near = false;
    point.plane = ContactPlane{};  // meets nothing unless found again
  }
  for (std::size_t o = 0; o < obstacle_count_; ++o) {
    // A plane comes nearest to a triangle at a corner.
    if (std::holds_alternative<HalfSpace>(*step.obstacles[o].shape)) continue;
    place_corners(step, contact, o);
    for (std::size_t t = 0; t < model_.skin_triangles.size(); ++t) {
      if (!is_free_[t]) continue;
      const int place = place_[t * obstacle_count_ + o];
      const Point* known = place >= 0 ? &points_[static_cast<std::size_t>(place)] : nullptr;
      const Found found = find(step, contact, t, o, known);
      if (known != nullptr) {
        if (found.known) move(step, contact, static_cast<std::size_t>(place), found, anchors);
      } else if (found.near) {
        const std::size_t k = free_place(correction);
        if (k < kMost) put(k, t, o, found, anchors);
      }
    }
  }
}

}  // namespace softfinger
