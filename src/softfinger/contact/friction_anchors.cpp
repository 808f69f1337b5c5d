// What a ContactPotential remembers from step to step: where friction holds, and from which side.
#include <algorithm>
#include <cmath>

#include "softfinger/contact/contact_potential.hpp"

namespace softfinger {
namespace {

/// What is left of the friction limit of a point that came off, so that it is known to have
/// touched, N.
constexpr double kLeastLimit = 1e-12;
/// With more overshoot than is usual a limit falls no further below the cone than this part of it.
constexpr double kMostBelow = 0.1;

double fall_beyond(double fall, double limit, double overshoot) {
  const double usual = std::min(overshoot, ContactPotential::kOvershoot) * fall;
  return std::max(usual, std::min(overshoot * fall, kMostBelow * limit));
}

}  // namespace

double ContactPotential::update_anchors(std::span<const Vector3> positions,
                                        std::span<FrictionAnchor> anchors) const {
  double change = 0.0;
  for (std::size_t i = 0; i < points_; ++i) {
    if (is_near_[i] == 0) continue;
    for (std::size_t o = 0; o < obstacle_count_; ++o) {
      const std::size_t k = i * obstacle_count_ + o;
      if (near_[k] == 0) continue;  // neither had friction nor has it now
      const Obstacle& obstacle = obstacles_[o];
      const Pair& pair = pairs_[k];
      FrictionAnchor& anchor = anchors[k];
      const double limit = obstacle.friction_coefficient * pair.pressing * pair.gradient.norm();
      change = std::max(change, std::abs(limit - anchor.limit));
      if (limit > 0.0) {
        const Pose& X_WO = obstacle_pose(i, o);
        const Vector3 normal = unit_normal(pair.gradient);
        // What is left of the displacement after sliding; none where contact is new.
        Vector3 u = Vector3::Zero();
        if (anchor.limit > 0.0) {
          u = positions[i] - X_WO * anchor.anchor_O;
          u -= normal * normal.dot(u);
          const double longest = std::min(limit, anchor.limit) / tangential_stiffness(i);
          const double length = u.norm();
          if (length > longest) u *= longest / length;
        }
        anchor.anchor_O = X_WO.inverse() * Vector3(positions[i] - u);
        anchor.normal_O = X_WO.rotation.transpose() * normal;
      }
      anchor.limit = limit;
      anchor.side = i < samples_ ? side_after(i, o, pair) : ContactSide{};
    }
  }
  return change;
}

ContactSide ContactPotential::side_after(std::size_t i, std::size_t o, const Pair& pair) const {
  if (pair.far || !(pair.gap < 0.0) || std::holds_alternative<HalfSpace>(*obstacles_[o].shape)) {
    return {};
  }
  const std::size_t k = i * obstacle_count_ + o;
  const ContactSide& side = anchors_[k].side.known ? anchors_[k].side : entered_[k];
  if (pair.behind) return side_above(*obstacles_[o].shape, side, pair.position_O);
  const Matrix3& R_OW = X_OW_[o].rotation;
  return side_at({pair.gap, R_OW * pair.gradient, Matrix3::Zero()}, pair.position_O);
}

double ContactPotential::update_limits(std::span<FrictionAnchor> anchors, bool only_lower,
                                       double overshoot) const {
  double change = 0.0;
  for (std::size_t i = 0; i < points_; ++i) {
    if (is_near_[i] == 0) continue;
    for (std::size_t o = 0; o < obstacle_count_; ++o) {
      const std::size_t k = i * obstacle_count_ + o;
      if (near_[k] == 0) continue;  // neither had friction nor has it now
      const Obstacle& obstacle = obstacles_[o];
      const Pair& pair = pairs_[k];
      FrictionAnchor& anchor = anchors[k];
      if (anchor.limit <= 0.0) continue;  // it touches for the first time: no history to slide from
      double limit = obstacle.friction_coefficient * pair.pressing * pair.gradient.norm();
      if (only_lower && limit >= anchor.limit) continue;
      if (only_lower)
        limit = std::max(0.0, limit - fall_beyond(anchor.limit - limit, limit, overshoot));
      change = std::max(change, std::abs(limit - anchor.limit));
      anchor.limit = std::max(limit, kLeastLimit);
      if (limit <= 0.0) continue;
      anchor.normal_O = obstacle_pose(i, o).rotation.transpose() * unit_normal(pair.gradient);
    }
  }
  return change;
}

/// visit(friction, limit): N, until it says false; whether it never did.
template <typename Visit>
bool ContactPotential::all_that_rub(const Visit& visit) const {
  for (std::size_t i = 0; i < points_; ++i) {
    if (is_near_[i] == 0) continue;
    for (std::size_t o = 0; o < obstacle_count_; ++o) {
      const std::size_t k = i * obstacle_count_ + o;
      if (near_[k] == 0 || !(pairs_[k].friction_limit > 0.0)) continue;
      const Pair& pair = pairs_[k];
      const double limit =
          obstacles_[o].friction_coefficient * pair.pressing * pair.gradient.norm();
      if (!visit(pair.friction_force.norm(), limit)) return false;
    }
  }
  return true;
}

double ContactPotential::beyond_cone() const {
  double sum = 0.0;
  all_that_rub([&](double friction, double limit) {
    sum += std::max(0.0, friction - limit);
    return true;
  });
  return sum;
}

bool ContactPotential::is_in_cone() const {
  return all_that_rub([](double friction, double limit) {
    return friction <= (1.0 + kConeRelative) * limit + kConeAbsolute;
  });
}

}  // namespace softfinger
