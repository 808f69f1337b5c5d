#include "softfinger/contact/contact_potential.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softfinger {
namespace {

/// Greatest slope of an interpolated distance; the true one has 1.
constexpr double kSteepest = 1.5;
/// Points further than this from an obstacle's box are passed over, m.
constexpr double kAround = 5e-4;
/// Bounds of what the distance to a shape is positive outside of, and not less than to them; a
/// mesh's interpolated distance may be less.
Eigen::AlignedBox3d bounds_by_distance(const Shape& shape) {
  return std::holds_alternative<MeshShape>(shape) ? bounds(HalfSpace{}) : bounds(shape);
}

/// Bounds in O seen from W, and kAround more.
Eigen::AlignedBox3d box_around(const Eigen::AlignedBox3d& bounds_O, const Pose& X_WO) {
  const Vector3 half_O = 0.5 * bounds_O.sizes();
  if (!half_O.allFinite()) return bounds_O;  // endless
  const Vector3 centre = X_WO * Vector3(bounds_O.min() + half_O);
  const Vector3 half = X_WO.rotation.cwiseAbs() * half_O + Vector3::Constant(kAround);
  return {centre - half, centre + half};
}

}  // namespace

ContactPotential::ContactPotential(std::vector<double> rest_areas, std::size_t samples,
                                   std::size_t obstacle_count, Options options)
    : rest_areas_(std::move(rest_areas)),
      samples_(samples),
      obstacle_count_(obstacle_count),
      options_(options) {
  planes_.reserve(rest_areas_.size() - samples_);
  pairs_.resize(rest_areas_.size() * obstacle_count_);
  sightings_.resize(pairs_.size());
  held_.resize(pairs_.size());
  tied_.resize(rest_areas_.size());
  near_.resize(pairs_.size());
  is_near_.resize(rest_areas_.size());
  positions_.resize(rest_areas_.size());
  X_OW_.resize(obstacle_count_);
  X_OW_old_.resize(obstacle_count_);
  wrenches_.resize(obstacle_count_);
  entered_.resize(pairs_.size());
  looked_back_.resize(pairs_.size());
  boxes_O_.resize(obstacle_count_);
  boxes_W_.resize(obstacle_count_);
}

void ContactPotential::forget() { std::fill(sightings_.begin(), sightings_.end(), Sighting{}); }

std::vector<FrictionAnchor> ContactPotential::no_anchors() const {
  return std::vector<FrictionAnchor>(pairs_.size());
}

void ContactPotential::begin(std::span<const Obstacle> obstacles,
                             std::span<const FrictionAnchor> anchors,
                             std::span<const Vector3> starts) {
  obstacles_ = obstacles;
  anchors_ = anchors;
  starts_ = starts;
  planes_.clear();
  std::fill(looked_back_.begin(), looked_back_.end(), std::uint8_t{0});
  for (std::size_t o = 0; o < obstacle_count_; ++o) {
    X_OW_[o] = obstacles[o].X_WO.inverse();
    X_OW_old_[o] = X_OW_[o];
    boxes_O_[o] = bounds_by_distance(*obstacles[o].shape);
    boxes_W_[o] = box_around(boxes_O_[o], obstacles[o].X_WO);
    // Nothing is near a soft obstacle but by its patches.
    if (obstacles[o].is_soft) boxes_W_[o].setEmpty();
    if (obstacles[o].X_WO_old && !obstacles[o].is_soft) {
      X_OW_old_[o] = obstacles[o].X_WO_old->inverse();
      boxes_W_[o].extend(box_around(boxes_O_[o], *obstacles[o].X_WO_old));
    }
    box_W_ = o == 0 ? boxes_W_[o] : box_W_.merged(boxes_W_[o]);
  }
  for (std::size_t i = 0; i < tied_.size(); ++i) {
    bool tied = false;
    for (std::size_t o = 0; o < obstacle_count_; ++o) {
      const std::size_t k = i * obstacle_count_ + o;
      held_[k] = anchors[k].limit > 0.0 || anchors[k].side.known ? 1 : 0;
      if (obstacles[o].is_soft) held_[k] = i < samples_ && may_meet(i, o) ? 1 : 0;
      tied = tied || held_[k] != 0;
    }
    tied_[i] = tied ? 1 : 0;
  }
}

void ContactPotential::add_plane(const ContactPlane& plane) {
  planes_.push_back(plane);
  if (plane.obstacle < 0) return;
  const Obstacle& obstacle = obstacles_[static_cast<std::size_t>(plane.obstacle)];
  if (!obstacle.moves) return;
  // Kept in O.
  planes_.back().offset += plane.normal.dot(obstacle.X_WO.translation);
  planes_.back().normal = obstacle.X_WO.rotation.transpose() * plane.normal;
}

void ContactPotential::follow(std::size_t o) {
  const Pose& X_WO = obstacles_[o].X_WO;
  X_OW_[o] = X_WO.inverse();
  boxes_W_[o].extend(box_around(boxes_O_[o], X_WO));
  box_W_.extend(boxes_W_[o]);
}

bool ContactPotential::comes_near(const Eigen::AlignedBox3d& box_W, std::size_t i,
                                  const Vector3& position) const {
  if (box_W.contains(position)) return true;
  if (starts_.empty()) return false;
  return (starts_[i].cwiseMax(position).array() >= box_W.min().array()).all() &&
         (starts_[i].cwiseMin(position).array() <= box_W.max().array()).all();
}

bool ContactPotential::may_act(std::size_t i, const Vector3& position) const {
  return i >= samples_ || tied_[i] != 0 || comes_near(box_W_, i, position);
}

bool ContactPotential::may_act(std::size_t i, std::size_t o, const Vector3& position) const {
  if (held_[i * obstacle_count_ + o] != 0) return true;
  if (i >= samples_) return planes_[i - samples_].obstacle == static_cast<int>(o);
  return comes_near(boxes_W_[o], i, position);
}

ContactSide ContactPotential::side_of(std::size_t i, std::size_t o, const Vector3& position_O,
                                      const SignedDistance& at, Pair& pair) const {
  const std::size_t k = i * obstacle_count_ + o;
  if (anchors_[k].side.known) return anchors_[k].side;
  if (looked_back_[k] != 0) return entered_[k];
  if (starts_.empty() || std::holds_alternative<HalfSpace>(*obstacles_[o].shape)) return {};
  const Vector3 start_O = X_OW_old_[o] * starts_[i];
  if (!may_have_passed(*obstacles_[o].shape, start_O, position_O, at)) return {};
  pair.entered = side_on_way(*obstacles_[o].shape, start_O, position_O);
  pair.looked_back = pair.entered.known;
  return pair.entered;
}

SignedDistance ContactPotential::look(std::size_t i, std::size_t o,
                                      const Vector3& position_O) const {
  const Shape& shape = *obstacles_[o].shape;
  const SignedDistance at = distance_and_gradient(shape, position_O);
  Pair pair;
  const ContactSide side = side_of(i, o, position_O, at, pair);
  return is_behind(shape, side, position_O, at) ? distance_to_side(side, position_O) : at;
}

double ContactPotential::friction(std::size_t i, const Pose& X_WO, const FrictionAnchor& anchor,
                                  const Vector3& position, Pair& pair) const {
  const double stiffness = tangential_stiffness(i);
  const Vector3 normal = X_WO.rotation * anchor.normal_O;
  const Vector3 from_anchor = position - X_WO * anchor.anchor_O;
  const Vector3 u = from_anchor - normal * normal.dot(from_anchor);
  pair.friction_normal = normal;
  pair.slip = u.norm();
  pair.slides = stiffness * pair.slip > anchor.limit;
  if (!pair.slides) {
    pair.friction_force = -stiffness * u;
    return 0.5 * stiffness * pair.slip * pair.slip;
  }
  pair.slip_direction = u / pair.slip;
  pair.friction_force = -anchor.limit * pair.slip_direction;
  return anchor.limit * (pair.slip - 0.5 * anchor.limit / stiffness);
}

bool ContactPotential::meet(std::size_t i, std::size_t o, const Vector3& position,
                            Pair& pair) const {
  const Obstacle& obstacle = obstacles_[o];
  if (obstacle.is_soft) {
    const SurfacePatch& patch = obstacle.patches[i];
    pair.position_O = patch.X_PW * position;
    pair.gap = pair.position_O.z();
    pair.gradient = patch.X_WP.rotation.col(2);
    pair.curvature.setZero();
    return true;
  }
  pair.position_O = X_OW_[o] * position;
  if (i >= samples_) {
    const ContactPlane& plane = planes_[i - samples_];
    pair.gap = std::numeric_limits<double>::infinity();
    if (plane.obstacle != static_cast<int>(o)) return false;
    pair.gap = plane.normal.dot(obstacle.moves ? pair.position_O : position) + plane.offset;
    pair.gradient = obstacle.moves ? Vector3(obstacle.X_WO.rotation * plane.normal) : plane.normal;
    pair.curvature.setZero();
    return true;
  }
  pair.gap = bound_by_sighting(i, o, pair.position_O);
  if (pair.gap > 0.0) return false;
  SignedDistance d = signed_distance(*obstacle.shape, pair.position_O);
  const ContactSide side = side_of(i, o, pair.position_O, d, pair);
  pair.behind = is_behind(*obstacle.shape, side, pair.position_O, d);
  if (pair.behind) d = distance_to_side(side, pair.position_O);
  pair.gap = d.distance;
  pair.gradient = obstacle.X_WO.rotation * d.gradient;
  if (d.distance < 0.0) {
    pair.curvature = obstacle.X_WO.rotation * d.hessian * obstacle.X_WO.rotation.transpose();
  }
  return true;
}

double ContactPotential::evaluate(std::size_t i, std::size_t o, const Vector3& position,
                                  Pair& pair) const {
  pair.looked_back = false;
  pair.behind = false;
  pair.far = !meet(i, o, position, pair);
  pair.pressing = 0.0;
  pair.friction_force.setZero();
  double energy = 0.0;
  if (pair.gap < 0.0) {
    pair.pressing = -normal_stiffness(i) * pair.gap;
    energy += 0.5 * pair.pressing * -pair.gap;
  }
  const FrictionAnchor& anchor = anchors_[i * obstacle_count_ + o];
  pair.friction_limit = anchor.limit;
  if (anchor.limit > 0.0) energy += friction(i, obstacle_pose(i, o), anchor, position, pair);
  return energy;
}

double ContactPotential::energy_gradient(std::span<const Vector3> positions,
                                         std::span<Vector3> gradient) {
  double energy = 0.0;
  double force_squared = 0.0;
  points_ = positions.size();
  std::copy(positions.begin(), positions.end(), positions_.begin());
  std::fill(wrenches_.begin(), wrenches_.end(), Wrench{});
  for (std::size_t i = 0; i < points_; ++i) {
    is_near_[i] = may_act(i, positions[i]) ? 1 : 0;
    if (is_near_[i] == 0) {
      std::fill_n(near_.begin() + static_cast<std::ptrdiff_t>(i * obstacle_count_), obstacle_count_,
                  std::uint8_t{0});
      continue;
    }
    for (std::size_t o = 0; o < obstacle_count_; ++o) {
      const bool near = may_act(i, o, positions[i]);
      near_[i * obstacle_count_ + o] = near ? 1 : 0;
      if (!near) continue;
      Pair& pair = pairs_[i * obstacle_count_ + o];
      energy += evaluate(i, o, positions[i], pair);
      const std::size_t k = i * obstacle_count_ + o;
      if (!pair.far && !obstacles_[o].is_soft) sightings_[k] = {pair.position_O, pair.gap};
      if (pair.looked_back) {
        entered_[k] = pair.entered;
        looked_back_[k] = 1;
      }
      const Vector3 force = pair.pressing * pair.gradient + pair.friction_force;
      gradient[i] -= force;
      force_squared += force.squaredNorm();
      if (pair.pressing > 0.0) {
        wrenches_[o].normal_force += pair.pressing * pair.gradient.norm();
      }
      if (!obstacles_[o].moves) continue;
      wrenches_[o].by_translation += force;
      wrenches_[o].by_rotation += (positions[i] - obstacles_[o].X_WO.translation).cross(force);
    }
  }
  force_norm_ = std::sqrt(force_squared);
  return energy;
}

bool ContactPotential::add_hessian(std::size_t i, std::size_t o, const Pair& pair,
                                   bool with_curvature, Matrix3& block) const {
  bool any = false;
  if (pair.gap < 0.0) {
    any = true;
    block += normal_stiffness(i) * pair.gradient * pair.gradient.transpose();
    if (with_curvature) block -= pair.pressing * pair.curvature;
  }
  const FrictionAnchor& anchor = anchors_[i * obstacle_count_ + o];
  if (anchor.limit > 0.0) {
    any = true;
    const Matrix3 tangent =
        Matrix3::Identity() - pair.friction_normal * pair.friction_normal.transpose();
    if (pair.slides) {
      block += anchor.limit / pair.slip *
               (tangent - pair.slip_direction * pair.slip_direction.transpose());
    } else {
      block += tangential_stiffness(i) * tangent;
    }
  }
  return any;
}

bool ContactPotential::hessian(std::size_t i, bool with_curvature, Matrix3& block) const {
  block.setZero();
  if (is_near_[i] == 0) return false;
  bool any = false;
  for (std::size_t o = 0; o < obstacle_count_; ++o) {
    if (near_[i * obstacle_count_ + o] == 0 || obstacles_[o].is_soft) continue;
    any = add_hessian(i, o, pairs_[i * obstacle_count_ + o], with_curvature, block) || any;
  }
  return any;
}

ContactPotential::Response ContactPotential::respond(std::size_t i, const Vector3& position) const {
  Response response;
  if (!may_act(i, position)) return response;
  Pair pair;
  for (std::size_t o = 0; o < obstacle_count_; ++o) {
    if (obstacles_[o].is_soft || !may_act(i, o, position)) continue;
    evaluate(i, o, position, pair);
    response.gradient -= pair.pressing * pair.gradient + pair.friction_force;
    add_hessian(i, o, pair, true, response.hessian);
  }
  return response;
}

ContactPotential::Response ContactPotential::respond_to_patch(std::size_t i, std::size_t o,
                                                              const Vector3& position) const {
  Response response;
  Pair pair;
  evaluate(i, o, position, pair);
  response.gradient = -(pair.pressing * pair.gradient + pair.friction_force);
  add_hessian(i, o, pair, true, response.hessian);
  return response;
}

double ContactPotential::patch_gap(std::size_t i, std::size_t o) const {
  if (!may_meet(i, o) || is_near_[i] == 0) return std::numeric_limits<double>::infinity();
  return pairs_[i * obstacle_count_ + o].gap;
}

Vector3 ContactPotential::patch_force(std::size_t i, std::size_t o) const {
  if (!may_meet(i, o) || is_near_[i] == 0) return Vector3::Zero();
  const Pair& pair = pairs_[i * obstacle_count_ + o];
  return pair.pressing * pair.gradient + pair.friction_force;
}

Matrix3 ContactPotential::following(std::size_t i, std::size_t o, const Pair& pair,
                                    bool with_curvature) const {
  Matrix3 gradient_by_position = Matrix3::Zero();
  if (pair.slides) {
    // The limit: mu times the normal force, which the gap takes away from.
    gradient_by_position = -obstacles_[o].friction_coefficient * normal_stiffness(i) *
                           pair.gradient.norm() * pair.slip_direction * pair.gradient.transpose();
  }
  if (!with_curvature) return gradient_by_position;
  // The plane that u lies in, u = a - n n.a with a the way from the anchor.
  const Vector3& n = pair.friction_normal;
  const Vector3 a =
      positions_[i] - obstacle_pose(i, o) * anchors_[i * obstacle_count_ + o].anchor_O;
  const Matrix3 u_by_normal = -n.dot(a) * Matrix3::Identity() - n * a.transpose();
  const Matrix3 u_by_position = u_by_normal * pair.curvature;
  if (!pair.slides) return gradient_by_position + tangential_stiffness(i) * u_by_position;
  const Matrix3 across =
      Matrix3::Identity() - pair.slip_direction * pair.slip_direction.transpose();
  return gradient_by_position + pair.friction_limit / pair.slip * across * u_by_position;
}

bool ContactPotential::pair_response(std::size_t i, std::size_t o, bool with_curvature,
                                     PairResponse& response) const {
  response = {};
  if (near_[i * obstacle_count_ + o] == 0) return false;
  const Pair& pair = pairs_[i * obstacle_count_ + o];
  if (!add_hessian(i, o, pair, with_curvature, response.hessian)) return false;
  response.outward = pair.gradient;
  response.normal_force = pair.pressing * pair.gradient;
  response.gradient = -response.normal_force - pair.friction_force;
  if (pair.gap < 0.0) {
    response.normal_stiffness = normal_stiffness(i) * pair.gradient * pair.gradient.transpose();
    if (with_curvature) response.normal_stiffness -= pair.pressing * pair.curvature;
    if (pair.friction_limit > 0.0) {
      response.following = following(i, o, pair, with_curvature);
    }
  }
  return true;
}

double ContactPotential::gap(std::size_t i) const {
  if (is_near_[i] == 0) return kAround;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t o = 0; o < obstacle_count_; ++o) {
    const std::size_t k = i * obstacle_count_ + o;
    if (obstacles_[o].is_soft) continue;
    if (near_[k] != 0) {
      least = std::min(least, pairs_[k].gap);
    } else if (i < samples_) {
      least = std::min(least, kAround);
    }
  }
  return least;
}

double ContactPotential::bound_by_sighting(std::size_t i, std::size_t o,
                                           const Vector3& position_O) const {
  const Sighting& sighting = sightings_[i * obstacle_count_ + o];
  return sighting.gap - kSteepest * (position_O - sighting.position_O).norm();
}

double ContactPotential::gap_bound(std::size_t i, std::size_t o, const Vector3& position_O) const {
  const double bound = bound_by_sighting(i, o, position_O);
  return bound > 0.0 ? bound : std::max(bound, boxes_O_[o].exteriorDistance(position_O));
}

ContactPotential::Forces ContactPotential::forces(std::size_t i) const {
  Forces sum;
  if (is_near_[i] == 0) return sum;
  for (std::size_t o = 0; o < obstacle_count_; ++o) {
    if (near_[i * obstacle_count_ + o] == 0) continue;
    const Pair& pair = pairs_[i * obstacle_count_ + o];
    sum.normal += pair.pressing * pair.gradient;
    sum.tangential += pair.friction_force;
    const double magnitude = pair.pressing * pair.gradient.norm();
    sum.normal_sum += magnitude;
    sum.friction_limit += obstacles_[o].friction_coefficient * magnitude;
    sum.slides = sum.slides || (pair.friction_limit > 0.0 && pair.slides);
  }
  return sum;
}

ContactPotential::Nearest ContactPotential::nearest(std::size_t i) const {
  Nearest nearest;
  for (std::size_t o = 0; o < obstacle_count_; ++o) {
    const std::size_t k = i * obstacle_count_ + o;
    SignedDistance d;
    if (near_[k] != 0 && !(pairs_[k].far && i < samples_)) {
      d.distance = pairs_[k].gap;
      d.gradient = pairs_[k].gradient;
    } else if (i < samples_ && !obstacles_[o].is_soft) {
      // Passed over, or known as a bound only.
      const double bound =
          near_[k] != 0 ? pairs_[k].gap : boxes_W_[o].exteriorDistance(positions_[i]);
      if (bound >= nearest.gap) continue;
      d = distance_and_gradient(*obstacles_[o].shape, X_OW_[o] * positions_[i]);
      d.gradient = obstacles_[o].X_WO.rotation * d.gradient;
    } else {
      continue;
    }
    if (d.distance >= nearest.gap) continue;
    nearest = {d.distance, unit_normal(d.gradient), static_cast<int>(o)};
  }
  return nearest;
}

}  // namespace softfinger
