#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/mechanism/mechanism_tables.hpp"

namespace softfinger {
namespace {

/// A joint with what the linkage needs of it; bodies by their place in the file, 0 is the base.
struct ReadJoint {
  NamedJoint named;
  LinkageBody body;
  LinkageCoordinates guess;
};

JointType joint_type(const std::string& name) {
  if (name == "revolute") return JointType::kRevolute;
  if (name == "prismatic") return JointType::kPrismatic;
  if (name == "universal") return JointType::kUniversal;
  if (name == "spherical") return JointType::kSpherical;
  if (name == "free") return JointType::kFree;
  return JointType::kFixed;
}

LinkageCoordinates read_guess(const ConfigTable& table, JointType type) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(3);
  LinkageCoordinates guess(coordinate_count(type));
  switch (type) {
    case JointType::kFixed:
      break;
    case JointType::kRevolute:
      guess[0] = table.number("guess_deg", kTurnRange, 0.0);
      break;
    case JointType::kPrismatic:
      guess[0] = table.number("guess_mm", kPlaceRange, 0.0);
      break;
    case JointType::kUniversal:
      guess = table.numbers("guess_deg", 2, kTurnRange, none.head(2));
      break;
    case JointType::kSpherical:
      guess = table.numbers("guess_rotation_vector_deg", 3, kTurnRange, none);
      break;
    case JointType::kFree:
      guess.head(3) = table.numbers("guess_position_mm", 3, kPlaceRange, none);
      guess.tail(3) = table.numbers("guess_rotation_vector_deg", 3, kTurnRange, none);
      break;
  }
  return guess;
}

void read_actuation(const ConfigTable& table, NamedJoint& joint) {
  joint.actuated = table.boolean("actuated", false);
  table.decides("actuated");
  if (!joint.actuated) return;
  if (joint.type != JointType::kRevolute && joint.type != JointType::kPrismatic) {
    table.fail("actuated", "only revolute and prismatic joints are moved by a motor");
  }
  const std::string key = joint.type == JointType::kRevolute ? "joint_deg" : "joint_mm";
  const Eigen::VectorXd limits =
      table.numbers(key, 2, joint.type == JointType::kRevolute ? kTurnRange : kPlaceRange);
  if (limits[0] >= limits[1]) table.fail(key, "must be [least, largest]");
  joint.min = limits[0];
  joint.max = limits[1];
}

ReadJoint read_joint(const ConfigTable& table, const std::vector<std::string>& bodies) {
  ReadJoint joint{{.table = table, .name = table.text("name")}, {}, {}};
  joint.named.type = joint_type(
      table.choice("type", {"revolute", "prismatic", "universal", "spherical", "free", "fixed"}));
  table.decides("type");
  joint.body.type = joint.named.type;
  joint.body.parent = read_name(table, "parent", bodies, "body");
  joint.named.body = read_name(table, "child", bodies, "body");
  if (joint.named.body == 0) table.fail("child", "the base is carried by nothing");
  joint.body.X_PJ = read_frame(table);
  if (joint.body.type == JointType::kRevolute || joint.body.type == JointType::kPrismatic ||
      joint.body.type == JointType::kUniversal) {
    joint.body.axis = read_axis(table, "axis", Vector3::UnitZ());
  }
  if (joint.body.type == JointType::kUniversal) {
    joint.body.second_axis = read_axis(table, "second_axis", Vector3::UnitX());
    if (joint.body.axis.cross(joint.body.second_axis).norm() < 1e-3) {
      table.fail("second_axis", "must not be parallel to axis");
    }
  }
  read_actuation(table, joint.named);
  joint.guess = read_guess(table, joint.body.type);
  return joint;
}

/// Two unit vectors perpendicular to an axis and to each other.
std::pair<Vector3, Vector3> across(const Vector3& axis) {
  Eigen::Index least = 0;
  axis.cwiseAbs().minCoeff(&least);
  const Vector3 first = axis.cross(Vector3::Unit(least)).normalized();
  return {first, axis.cross(first)};
}

/// The equations of one `[[loop]]`: those of the joint of that type.
void read_loop(const ConfigTable& table, const std::vector<std::string>& bodies, int loop,
               std::vector<LoopEquation>& equations) {
  const std::string type = table.choice(
      "type", {"spherical", "revolute", "universal", "prismatic", "cylindrical", "fixed"});
  table.decides("type");
  LoopEquation common;
  common.loop = loop;
  common.a = read_name(table, "body_a", bodies, "body");
  common.b = read_name(table, "body_b", bodies, "body");
  if (common.a == common.b) table.fail("body_b", "must be another body than body_a");
  const Pose X_aA = read_frame(table, "_a");
  const Pose X_bB = read_frame(table, "_b");
  common.point_a = X_aA.translation;
  common.point_b = X_bB.translation;
  const bool has_axis = type != "spherical" && type != "fixed";
  const Vector3 axis =
      has_axis ? read_axis(table, "axis", Vector3::UnitZ()) : Vector3(Vector3::UnitZ());
  const auto along = [&](const Vector3& direction) {
    common.kind = LoopEquation::Kind::kAlong;
    common.direction_a = X_aA.rotation * direction;
    equations.push_back(common);
  };
  const auto perpendicular = [&](const Vector3& direction_a, const Vector3& direction_b) {
    common.kind = LoopEquation::Kind::kAcross;
    common.direction_a = X_aA.rotation * direction_a;
    common.direction_b = X_bB.rotation * direction_b;
    equations.push_back(common);
  };
  const auto [first, second] = across(axis);
  along(first);
  along(second);
  if (type != "prismatic" && type != "cylindrical") along(axis);
  if (type == "revolute" || type == "cylindrical") {
    perpendicular(first, axis);
    perpendicular(second, axis);
  } else if (type == "universal") {
    perpendicular(axis, read_axis(table, "second_axis", Vector3::UnitX()));
  } else if (type == "prismatic" || type == "fixed") {
    perpendicular(Vector3::UnitX(), Vector3::UnitY());
    perpendicular(Vector3::UnitY(), Vector3::UnitZ());
    perpendicular(Vector3::UnitZ(), Vector3::UnitX());
  }
}

/// Places in the file in an order where parents come first.
std::vector<int> parents_first(const std::vector<std::optional<ReadJoint>>& carriers) {
  std::vector<int> order{0};
  std::vector<bool> placed(carriers.size(), false);
  placed[0] = true;
  const auto coordinates = [&](std::size_t b) { return coordinate_count(carriers[b]->body.type); };
  for (std::size_t round = 1; round < carriers.size(); ++round) {
    // Of those that may follow the one with the fewest coordinates: the legs before the platform
    // that they carry, as its coordinates are in all their loops, which then stay sparse.
    std::size_t next = 0;
    for (std::size_t b = 1; b < carriers.size(); ++b) {
      if (placed[b] || !placed[static_cast<std::size_t>(carriers[b]->body.parent)]) continue;
      if (next == 0 || coordinates(b) < coordinates(next)) next = b;
    }
    if (next == 0) break;
    placed[next] = true;
    order.push_back(static_cast<int>(next));
  }
  for (std::size_t b = 1; b < carriers.size(); ++b) {
    if (!placed[b]) {
      carriers[b]->named.table.fail(
          "parent", "no joints lead from here to the base; close a ring with [[loop]] instead");
    }
  }
  return order;
}

/// How large the mechanism is: its farthest joint or attachment from the origin of its body.
double measure(const std::vector<LinkageBody>& bodies, const std::vector<LoopEquation>& equations) {
  double length = 0.0;
  for (const LinkageBody& body : bodies) length = std::max(length, body.X_PJ.translation.norm());
  for (const LoopEquation& equation : equations) {
    length = std::max({length, equation.point_a.norm(), equation.point_b.norm()});
  }
  return length > 0.0 ? length : 10.0 * mm;
}

}  // namespace

LinkageTables read_linkage(const ConfigTable& root) {
  std::vector<std::string> in_file{"base"};
  const std::vector<ConfigTable> body_tables = root.tables("body");
  root.needs_one("body");
  if (body_tables.empty()) root.fail("body", "a mechanism needs bodies that move ([[body]])");
  if (body_tables.size() >= kMaxLinkageBodies) {
    root.fail("body",
              fmt::format("{} bodies; at most {}", body_tables.size(), kMaxLinkageBodies - 1));
  }
  for (const ConfigTable& table : body_tables) {
    const std::string name = table.text("name");
    if (name.empty()) table.fail("name", "must not be empty");
    if (std::find(in_file.begin(), in_file.end(), name) != in_file.end()) {
      table.fail("name", fmt::format("'{}' is a body already", name.substr(0, 60)));
    }
    in_file.push_back(name);
  }

  std::vector<std::optional<ReadJoint>> carriers(in_file.size());
  std::vector<NamedJoint> joints;
  int coordinates = 0;
  const std::vector<ConfigTable> joint_tables = root.tables("joint");
  root.needs_one("joint");
  for (const ConfigTable& table : joint_tables) {
    ReadJoint joint = read_joint(table, in_file);
    auto& carrier = carriers[static_cast<std::size_t>(joint.named.body)];
    if (carrier) {
      table.fail("child", fmt::format("'{}' hangs on joint '{}' already; close loops with [[loop]]",
                                      in_file[static_cast<std::size_t>(joint.named.body)],
                                      carrier->named.name));
    }
    if (std::any_of(joints.begin(), joints.end(),
                    [&](const NamedJoint& other) { return other.name == joint.named.name; })) {
      table.fail("name", fmt::format("'{}' is a joint already", joint.named.name.substr(0, 60)));
    }
    coordinates += coordinate_count(joint.body.type);
    if (coordinates > kMaxLinkageCoordinates) {
      table.fail("type", fmt::format("with this joint the joints have {} coordinates; at most {}",
                                     coordinates, kMaxLinkageCoordinates));
    }
    joints.push_back(joint.named);
    carrier = std::move(joint);
  }
  for (std::size_t b = 1; b < carriers.size(); ++b) {
    if (!carriers[b]) {
      body_tables[b - 1].fail("name", fmt::format("no joint carries '{}' ([[joint]] child = ...)",
                                                  in_file[b].substr(0, 60)));
    }
  }

  const std::vector<int> order = parents_first(carriers);
  std::vector<int> place(order.size());  // in the linkage's order, of a body of the file
  for (std::size_t k = 0; k < order.size(); ++k) {
    place[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
  }
  std::vector<std::string> names;
  std::vector<LinkageBody> bodies;
  LinkageCoordinates guess(coordinates);
  int filled = 0;
  for (const int b : order) {
    names.push_back(in_file[static_cast<std::size_t>(b)]);
    if (b == 0) continue;
    const ReadJoint& joint = *carriers[static_cast<std::size_t>(b)];
    bodies.push_back(joint.body);
    bodies.back().parent = place[static_cast<std::size_t>(joint.body.parent)];
    const int count = coordinate_count(joint.body.type);
    guess.segment(filled, count) = joint.guess;
    filled += count;
  }
  for (NamedJoint& joint : joints) joint.body = place[static_cast<std::size_t>(joint.body)];

  const std::vector<ConfigTable> loops = root.tables("loop");
  std::vector<LoopEquation> equations;
  for (std::size_t k = 0; k < loops.size(); ++k) {
    read_loop(loops[k], names, static_cast<int>(k), equations);
    if (equations.size() > 2 * kMaxLinkageCoordinates) {
      loops[k].fail("", fmt::format("with this loop there are {} equations; at most {}",
                                    equations.size(), 2 * kMaxLinkageCoordinates));
    }
  }
  const double length = measure(bodies, equations);
  return {.bodies = std::move(names),
          .joints = std::move(joints),
          .loops = loops,
          .linkage = Linkage(bodies, std::move(equations), length),
          .guess = guess};
}

}  // namespace softfinger
