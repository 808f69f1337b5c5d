#include "softfinger/world/body_tree.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "softfinger/base/error.hpp"
#include "softfinger/geometry/mass_properties.hpp"

namespace softfinger {
namespace {

int freedoms_of(const std::optional<Joint>& joint) {
  if (!joint) return 6;
  switch (joint->kind) {
    case JointKind::kSlider:
    case JointKind::kHinge:
      return 1;
    case JointKind::kBall:
      return 3;
    case JointKind::kFixed:
      break;
  }
  return 0;
}

BodyInertia inertia_of(const VirtualObject& object) {
  const std::optional<MassProperties> even = mass_properties(object.shape);
  if (!even || !(even->volume > 0.0)) {
    throw InputError(fmt::format("object '{}' has no volume that a mass could fill", object.name));
  }
  BodyInertia inertia;
  inertia.mass = object.dynamics->mass;
  inertia.centre_O = even->centre_O;
  inertia.second_O = inertia.mass / even->volume * even->second_moment_O;
  return inertia;
}

Vector6 twist_of(const Vector3& translation, const Vector3& rotation) {
  Vector6 twist;
  twist << translation, rotation;
  return twist;
}

}  // namespace

double inertia_about(const Joint& joint, const BodyInertia& inertia) {
  if (joint.kind == JointKind::kSlider) return inertia.mass;
  const Vector3 way = inertia.centre_O - joint.point_O;
  const Vector3& axis = joint.axis_O;
  return inertia.second_O.trace() - axis.dot(inertia.second_O * axis) +
         inertia.mass * axis.cross(way).squaredNorm();
}

BodyTree::BodyTree(std::span<const VirtualObject> objects)
    : objects_(objects), body_of_object_(objects.size(), -1) {
  std::size_t count = 0;
  for (const VirtualObject& object : objects) count += object.dynamics ? 1U : 0U;
  // Parents first: those whose parents are known, as often as there are generations.
  while (bodies_.size() < count) {
    const std::size_t before = bodies_.size();
    for (std::size_t o = 0; o < objects.size(); ++o) {
      const VirtualObject& object = objects[o];
      if (!object.dynamics || body_of_object_[o] >= 0) continue;
      const std::optional<Joint>& joint = object.dynamics->joint;
      Body body{.object = o, .inertia = inertia_of(object), .joint = joint};
      body.X_PO = object.motion.sample(0.0);
      if (joint && joint->parent >= 0) {
        const auto p = static_cast<std::size_t>(joint->parent);
        body.parent = body_of_object_[p];
        if (objects[p].dynamics && body.parent < 0) continue;
        body.stands_still = !objects[p].dynamics && !objects[p].motion.moves();
        body.X_PO = objects[p].motion.sample(0.0).inverse() * body.X_PO;
      }
      body.first = freedoms_;
      body.freedoms = freedoms_of(joint);
      auto columns = static_cast<std::size_t>(body.freedoms);
      for (int p = body.parent; p >= 0; p = bodies_[static_cast<std::size_t>(p)].parent) {
        columns += static_cast<std::size_t>(bodies_[static_cast<std::size_t>(p)].freedoms);
      }
      if (columns > kMostColumns) {
        throw InputError(
            fmt::format("object '{}' hangs on a chain of joints with {} degrees of "
                        "freedom; at most {}",
                        object.name, columns, kMostColumns));
      }
      freedoms_ += body.freedoms;
      body_of_object_[o] = static_cast<int>(bodies_.size());
      all_.push_back(bodies_.size());
      bodies_.push_back(body);
    }
    if (bodies_.size() == before) throw InputError("the joints of objects make a loop");
  }
}

std::vector<BodyPlace> BodyTree::start() const {
  std::vector<BodyPlace> places(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    places[b].X_WO = objects_[bodies_[b].object].motion.sample(0.0);
  }
  return places;
}

Pose BodyTree::parent_pose(const Body& body, std::span<const BodyPlace> places, double time) const {
  if (body.parent >= 0) return places[static_cast<std::size_t>(body.parent)].X_WO;
  if (!body.joint || body.joint->parent < 0) return {};
  return objects_[static_cast<std::size_t>(body.joint->parent)].motion.sample(time);
}

void BodyTree::put_on_parent(std::size_t b, double time, std::span<BodyPlace> places) const {
  const Body& body = bodies_[b];
  const Joint& joint = *body.joint;
  BodyPlace& place = places[b];
  Pose moved;
  if (joint.kind == JointKind::kSlider) {
    moved.translation = place.q * joint.axis_O;
  } else if (joint.kind != JointKind::kFixed) {
    moved.rotation =
        joint.kind == JointKind::kBall ? place.turn : exp_rotation(Vector3(place.q * joint.axis_O));
    moved.translation = joint.point_O - moved.rotation * joint.point_O;
  }
  place.X_WO = parent_pose(body, places, time) * body.X_PO * moved;
}

void BodyTree::advance(std::span<const std::size_t> which, std::span<const BodyPlace> from,
                       std::span<const double> direction, double t, double time,
                       std::span<BodyPlace> to) const {
  for (const std::size_t b : which) {
    const Body& body = bodies_[b];
    const double* const d = direction.data() + body.first;
    BodyPlace& place = to[b];
    place.q = from[b].q;
    place.turn = from[b].turn;
    if (body.joint) {
      if (body.freedoms == 1) place.q += t * d[0];
      if (body.joint->kind == JointKind::kBall) {
        const Matrix3 R_WB = parent_pose(body, from, time).rotation * body.X_PO.rotation;
        const Vector3 turn_W = t * Eigen::Map<const Vector3>(d);
        place.turn = exp_rotation(Vector3(R_WB.transpose() * turn_W)) * from[b].turn;
      }
      put_on_parent(b, time, to);
      continue;
    }
    const Pose& X_WO = from[b].X_WO;
    place.X_WO.rotation =
        exp_rotation(Vector3(t * Eigen::Map<const Vector3>(d + 3))) * X_WO.rotation;
    place.X_WO.translation = centre(b, X_WO) + t * Eigen::Map<const Vector3>(d) -
                             place.X_WO.rotation * body.inertia.centre_O;
  }
}

void BodyTree::columns(std::span<const std::size_t> which, std::span<const BodyPlace> places,
                       double time, std::span<Columns> out) const {
  for (const std::size_t b : which) {
    const Body& body = bodies_[b];
    const Vector3& origin = places[b].X_WO.translation;
    Columns& own = out[b];
    own.count = 0;
    if (body.parent >= 0) {
      const auto p = static_cast<std::size_t>(body.parent);
      const Vector3 way = origin - places[p].X_WO.translation;
      for (const Column& column : out[p].all()) {
        const Vector3 turn = column.twist.tail<3>();
        own.columns[own.count++] = {column.coordinate,
                                    twist_of(column.twist.head<3>() + turn.cross(way), turn)};
      }
    }
    if (!body.joint) {
      const Vector3 from_centre = origin - centre(b, places[b].X_WO);
      for (int c = 0; c < 3; ++c) {
        own.columns[own.count++] = {body.first + c, twist_of(Vector3::Unit(c), Vector3::Zero())};
      }
      for (int c = 0; c < 3; ++c) {
        const Vector3 turn = Vector3::Unit(c);
        own.columns[own.count++] = {body.first + 3 + c, twist_of(turn.cross(from_centre), turn)};
      }
      continue;
    }
    const Joint& joint = *body.joint;
    const Pose X_WB = parent_pose(body, places, time) * body.X_PO;
    const Vector3 from_point = origin - X_WB * joint.point_O;
    if (joint.kind == JointKind::kSlider) {
      own.columns[own.count++] = {body.first,
                                  twist_of(X_WB.rotation * joint.axis_O, Vector3::Zero())};
    } else if (joint.kind == JointKind::kHinge) {
      const Vector3 axis = X_WB.rotation * joint.axis_O;
      own.columns[own.count++] = {body.first, twist_of(axis.cross(from_point), axis)};
    } else if (joint.kind == JointKind::kBall) {
      for (int c = 0; c < 3; ++c) {
        const Vector3 axis = Vector3::Unit(c);
        own.columns[own.count++] = {body.first + c, twist_of(axis.cross(from_point), axis)};
      }
    }
  }
}

}  // namespace softfinger
