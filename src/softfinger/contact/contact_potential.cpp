#include "softfinger/contact/contact_potential.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softfinger {

ContactPotential::ContactPotential(std::vector<double> rest_areas, std::size_t obstacle_count,
                                   Options options)
    : rest_areas_(std::move(rest_areas)), obstacle_count_(obstacle_count), options_(options) {
  pairs_.resize(rest_areas_.size() * obstacle_count_);
}

std::vector<FrictionAnchor> ContactPotential::no_anchors() const {
  return std::vector<FrictionAnchor>(pairs_.size());
}

void ContactPotential::begin(std::span<const Obstacle> obstacles,
                             std::span<const FrictionAnchor> anchors) {
  obstacles_ = obstacles;
  anchors_ = anchors;
}

double ContactPotential::friction(std::size_t i, const Obstacle& obstacle,
                                  const FrictionAnchor& anchor, const Vector3& position,
                                  Pair& pair) const {
  const double stiffness = tangential_stiffness(i);
  const Vector3 normal = obstacle.X_WO.rotation * anchor.normal_O;
  const Vector3 from_anchor = position - obstacle.X_WO * anchor.anchor_O;
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

double ContactPotential::evaluate(std::size_t i, std::size_t o, const Vector3& position,
                                  Pair& pair) const {
  const Obstacle& obstacle = obstacles_[o];
  const SignedDistance d = signed_distance(*obstacle.shape, obstacle.X_WO.inverse() * position);
  pair.gap = d.distance;
  pair.normal = obstacle.X_WO.rotation * d.gradient;
  pair.normal_force = 0.0;
  pair.friction_force.setZero();
  double energy = 0.0;
  if (d.distance < 0.0) {
    pair.curvature = obstacle.X_WO.rotation * d.hessian * obstacle.X_WO.rotation.transpose();
    pair.normal_force = -normal_stiffness(i) * d.distance;
    energy += 0.5 * pair.normal_force * -d.distance;
  }
  const FrictionAnchor& anchor = anchors_[i * obstacle_count_ + o];
  pair.friction_limit = anchor.limit;
  if (anchor.limit > 0.0) energy += friction(i, obstacle, anchor, position, pair);
  return energy;
}

double ContactPotential::energy_gradient(std::span<const Vector3> positions,
                                         std::span<Vector3> gradient) {
  double energy = 0.0;
  double force_squared = 0.0;
  for (std::size_t i = 0; i < rest_areas_.size(); ++i) {
    for (std::size_t o = 0; o < obstacle_count_; ++o) {
      Pair& pair = pairs_[i * obstacle_count_ + o];
      energy += evaluate(i, o, positions[i], pair);
      const Vector3 force = pair.normal_force * pair.normal + pair.friction_force;
      gradient[i] -= force;
      force_squared += force.squaredNorm();
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
    block += normal_stiffness(i) * pair.normal * pair.normal.transpose();
    if (with_curvature) block -= pair.normal_force * pair.curvature;
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
  bool any = false;
  for (std::size_t o = 0; o < obstacle_count_; ++o) {
    any = add_hessian(i, o, pairs_[i * obstacle_count_ + o], with_curvature, block) || any;
  }
  return any;
}

ContactPotential::Response ContactPotential::respond(std::size_t i, const Vector3& position) const {
  Response response;
  Pair pair;
  for (std::size_t o = 0; o < obstacle_count_; ++o) {
    evaluate(i, o, position, pair);
    response.gradient -= pair.normal_force * pair.normal + pair.friction_force;
    add_hessian(i, o, pair, true, response.hessian);
  }
  return response;
}

double ContactPotential::gap(std::size_t i) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t o = 0; o < obstacle_count_; ++o) {
    least = std::min(least, pairs_[i * obstacle_count_ + o].gap);
  }
  return least;
}

double ContactPotential::update_anchors(std::span<const Vector3> positions,
                                        std::span<FrictionAnchor> anchors) const {
  double change = 0.0;
  for (std::size_t i = 0; i < rest_areas_.size(); ++i) {
    for (std::size_t o = 0; o < obstacle_count_; ++o) {
      const Obstacle& obstacle = obstacles_[o];
      const Pair& pair = pairs_[i * obstacle_count_ + o];
      FrictionAnchor& anchor = anchors[i * obstacle_count_ + o];
      const double limit = obstacle.friction_coefficient * pair.normal_force;
      change = std::max(change, std::abs(limit - anchor.limit));
      if (limit > 0.0) {
        // What is left of the displacement after sliding; none where contact is new.
        Vector3 u = Vector3::Zero();
        if (anchor.limit > 0.0) {
          u = positions[i] - obstacle.X_WO * anchor.anchor_O;
          u -= pair.normal * pair.normal.dot(u);
          const double longest = std::min(limit, anchor.limit) / tangential_stiffness(i);
          const double length = u.norm();
          if (length > longest) u *= longest / length;
        }
        anchor.anchor_O = obstacle.X_WO.inverse() * Vector3(positions[i] - u);
        anchor.normal_O = obstacle.X_WO.rotation.transpose() * pair.normal;
      }
      anchor.limit = limit;
    }
  }
  return change;
}

double ContactPotential::update_limits(std::span<FrictionAnchor> anchors) const {
  double change = 0.0;
  for (std::size_t i = 0; i < rest_areas_.size(); ++i) {
    for (std::size_t o = 0; o < obstacle_count_; ++o) {
      const Obstacle& obstacle = obstacles_[o];
      const Pair& pair = pairs_[i * obstacle_count_ + o];
      FrictionAnchor& anchor = anchors[i * obstacle_count_ + o];
      if (anchor.limit <= 0.0) continue;  // it touches for the first time: no history to slide from
      const double limit = obstacle.friction_coefficient * pair.normal_force;
      change = std::max(change, std::abs(limit - anchor.limit));
      if (limit <= 0.0) continue;
      anchor.limit = limit;
      anchor.normal_O = obstacle.X_WO.rotation.transpose() * pair.normal;
    }
  }
  return change;
}

void ContactPotential::report(std::size_t i, ContactSample& sample) const {
  sample.gap = std::numeric_limits<double>::infinity();
  sample.object = -1;
  sample.normal_F = Vector3::UnitZ();
  sample.normal_force = 0.0;
  sample.tangential_force_F.setZero();
  sample.friction_limit = 0.0;
  sample.slides = false;
  Vector3 normal_sum = Vector3::Zero();
  for (std::size_t o = 0; o < obstacle_count_; ++o) {
    const Pair& pair = pairs_[i * obstacle_count_ + o];
    normal_sum += pair.normal_force * pair.normal;
    sample.tangential_force_F += pair.friction_force;
    sample.friction_limit += pair.friction_limit;
    sample.slides = sample.slides || (pair.friction_limit > 0.0 && pair.slides);
    if (pair.gap < sample.gap) {
      sample.gap = pair.gap;
      sample.object = static_cast<int>(o);
      sample.normal_F = pair.normal;
    }
  }
  sample.normal_force = normal_sum.norm();
}

}  // namespace softfinger
