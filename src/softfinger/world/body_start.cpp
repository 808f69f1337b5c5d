#include "softfinger/world/body_start.hpp"

namespace softfinger {
namespace {

/// Of the velocity that the scene gives a body at the start, what its joint allows: a rate by each
/// of its own coordinates. A hinge takes the turn about its axis, or where that is none, the way of
/// the centre of mass; a ball the turn.
Vector3 start_rates(std::span<const BodyTree::Column> own, const ObjectDynamics& starts,
                    const Vector3& centre_from_origin) {
  Vector3 rates = Vector3::Zero();
  if (own.size() > 1) return starts.angular_velocity_W;
  for (const BodyTree::Column& column : own) {
    const Vector3 turn = column.twist.tail<3>();
    const Vector3 way = column.twist.head<3>() + turn.cross(centre_from_origin);
    rates[0] = turn.dot(starts.angular_velocity_W);
    if (rates[0] == 0.0 && way.squaredNorm() > 0.0) {
      rates[0] = way.dot(starts.velocity_W) / way.squaredNorm();
    }
  }
  return rates;
}

}  // namespace

std::vector<BodyMotion> motions_at_start(const BodyTree& tree,
                                         std::span<const VirtualObject> objects,
                                         std::span<const BodyPlace> places) {
  std::vector<BodyTree::Columns> columns(places.size());
  tree.columns(tree.all(), places, 0.0, columns);
  std::vector<BodyMotion> motions;
  motions.reserve(places.size());
  for (std::size_t b = 0; b < places.size(); ++b) {
    const Body& body = tree.bodies()[b];
    const ObjectDynamics& starts = *objects[body.object].dynamics;
    const Vector3 centre = tree.centre(b, places[b].X_WO) - places[b].X_WO.translation;
    Vector3 velocity = starts.velocity_W;
    Vector3 spin = starts.angular_velocity_W;
    double rate = 0.0;
    if (body.joint) {
      const std::span<const BodyTree::Column> all = columns[b].all();
      const auto own = all.last(static_cast<std::size_t>(body.freedoms));
      const Vector3 rates = start_rates(own, starts, centre);
      if (body.freedoms == 1) rate = rates[0];
      Vector6 twist = Vector6::Zero();  // of O's origin
      for (std::size_t c = 0; c < own.size(); ++c) {
        twist += rates[static_cast<int>(c)] * own[c].twist;
      }
      if (body.parent >= 0) {
        const auto p = static_cast<std::size_t>(body.parent);
        const Vector3 turn = motions[p].angular_velocity();
        const Vector3 way = places[b].X_WO.translation - tree.centre(p, places[p].X_WO);
        twist.head<3>() += motions[p].velocity() + turn.cross(way);
        twist.tail<3>() += turn;
      }
      spin = twist.tail<3>();
      velocity = twist.head<3>() + spin.cross(centre);
    }
    motions.emplace_back(body, places[b], velocity, spin, rate);
  }
  return motions;
}

}  // namespace softfinger
