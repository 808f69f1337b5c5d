#include "softfinger/scene/object_dynamics_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "softfinger/geometry/mass_properties.hpp"

namespace softfinger {
namespace {

// In the units of the file, as in scene_file.cpp.
const Range kMass = Range::between(1e-3, 1e5);             // g
const Range kDensity = Range::between(1.0, 1e5);           // kg/m^3
const Range kVelocity = Range::between(-1e4, 1e4);         // mm/s
const Range kAngularVelocity = Range::between(-1e5, 1e5);  // deg/s
const Range kPlace = Range::between(-1e5, 1e5);            // mm
const Range kStiffness = Range::between(0.0, 1e6);
const Range kForce = Range::between(-1e4, 1e4);
constexpr int kMostCurvePoints = 64;
constexpr double kLightest = 1e-6;  // kg
constexpr double kHeaviest = 100.0;

constexpr const char* kJointKinds[] = {"slider", "hinge", "ball", "fixed"};

void read_limits(const ConfigTable& table, const char* key, Joint& joint) {
  if (!table.has(key)) {
    (void)table.numbers(key, 2, Range::any(), Eigen::Vector2d::Zero());
    return;
  }
  const Eigen::VectorXd limits = table.numbers(key, 2);
  if (!(limits[0] < limits[1])) {
    table.fail(key, "the first limit must be less than the second");
  }
  if (limits[0] > 0.0 || limits[1] < 0.0) {
    table.fail(key, "the joint is at 0 at the start, which must be within the limits");
  }
  joint.limits = {limits[0], limits[1]};
}

JointCurve read_curve(const ConfigTable& table) {
  const Eigen::VectorXd travel = table.some_numbers("travel_mm", 2, kMostCurvePoints, kPlace);
  const Eigen::VectorXd force = table.some_numbers("force_N", 2, kMostCurvePoints, kForce);
  if (travel.size() != force.size()) {
    table.fail("force_N", fmt::format("has {} numbers, travel_mm has {}; a force for each travel",
                                      force.size(), travel.size()));
  }
  for (Eigen::Index i = 1; i < travel.size(); ++i) {
    if (!(travel[i] > travel[i - 1])) table.fail("travel_mm", "its numbers must increase");
  }
  return {{travel.begin(), travel.end()}, {force.begin(), force.end()}};
}

void read_slider(const ConfigTable& table, Joint& joint) {
  read_limits(table, "limits_mm", joint);
  joint.spring = table.number("spring_N_per_mm", kStiffness, 0.0);
  joint.rest = table.number("rest_mm", kPlace, 0.0);
  joint.damping = table.number("damping_N_s_per_mm", kStiffness, 0.0);
  joint.friction = table.number("friction_N", Range::between(0.0, 1e4), 0.0);
  const auto curve = table.optional_table("curve");
  if (!curve) return;
  if (table.has("spring_N_per_mm")) {
    table.fail("spring_N_per_mm", "a slider has a spring or a [object.joint.curve], not both");
  }
  joint.curve = read_curve(*curve);
}

void read_hinge(const ConfigTable& table, Joint& joint) {
  read_limits(table, "limits_deg", joint);
  joint.spring = table.number("spring_N_mm_per_rad", kStiffness, 0.0);
  joint.rest = table.number("rest_deg", Range::between(-1e5, 1e5), 0.0);
  joint.damping = table.number("damping_N_mm_s_per_rad", kStiffness, 0.0);
  joint.friction = table.number("friction_N_mm", Range::between(0.0, 1e6), 0.0);
  if (const auto detents = table.optional_table("detents")) {
    joint.detents =
        JointDetents{.count = detents->integer("count", 1, 1000),
                     .torque = detents->number("torque_N_mm", Range::between(0.0, 1e5))};
  }
}

Joint read_joint(const ConfigTable& table) {
  Joint joint;
  const std::string kind = table.choice("kind", {kJointKinds, kJointKinds + 4});
  table.decides("kind");
  joint.kind = static_cast<JointKind>(std::ranges::find(kJointKinds, kind) - kJointKinds);
  const bool has_axis = joint.kind == JointKind::kSlider || joint.kind == JointKind::kHinge;
  if (has_axis) {
    const Vector3 axis = table.numbers("axis", 3, Range::between(-1e3, 1e3));
    if (!(axis.norm() > 1e-6)) table.fail("axis", "expected a direction, not zero");
    joint.axis_O = axis.normalized();
  }
  if (joint.kind == JointKind::kHinge || joint.kind == JointKind::kBall) {
    joint.point_O = table.numbers("point_mm", 3, kPlace, Vector3::Zero());
  }
  if (joint.kind == JointKind::kSlider) read_slider(table, joint);
  if (joint.kind == JointKind::kHinge) read_hinge(table, joint);
  if (joint.limits && (joint.rest < (*joint.limits)[0] || joint.rest > (*joint.limits)[1])) {
    table.fail(joint.kind == JointKind::kSlider ? "rest_mm" : "rest_deg",
               "must be within the limits");
  }
  return joint;
}

void read_mass(const ConfigTable& table, ReadDynamics& read) {
  const std::optional<double> mass = table.optional_number("mass_g", kMass);
  read.density = table.optional_number("density_kg_per_m3", kDensity);
  if (mass && read.density) {
    table.fail("density_kg_per_m3", "an object has a mass_g or a density, not both");
  }
  if (!mass && !read.density) {
    table.fail("mass_g",
               "an object with motion = \"dynamic\" needs a mass_g or a density_kg_per_m3");
  }
  read.dynamics.mass = mass.value_or(0.0);
}

}  // namespace

std::optional<ReadDynamics> read_dynamics(const ConfigTable& table, bool is_plane) {
  if (table.choice("motion", {"scripted", "dynamic"}, "scripted") == "scripted") {
    table.decides("motion");
    return {};
  }
  if (is_plane) {
    table.fail("motion", "a plane has no end and no mass: it is never dynamic; use a box");
  }
  table.decides("motion");
  ReadDynamics read{.table = table, .dynamics = {}, .density = {}, .joint = {}, .parent = {}};
  read_mass(table, read);
  read.dynamics.velocity_W = table.numbers("velocity_mm_per_s", 3, kVelocity, Vector3::Zero());
  read.dynamics.angular_velocity_W =
      table.numbers("angular_velocity_deg_per_s", 3, kAngularVelocity, Vector3::Zero());
  if (!table.tables("waypoint").empty()) {
    table.fail("waypoint", "a dynamic object moves by the forces on it and takes no waypoints");
  }
  read.joint = table.optional_table("joint");
  if (read.joint) {
    read.parent = read.joint->optional_text("parent");
    read.dynamics.joint = read_joint(*read.joint);
  }
  return read;
}

void finish_dynamics(const std::vector<std::pair<std::size_t, ReadDynamics>>& all,
                     std::vector<VirtualObject>& objects) {
  for (const auto& [o, read] : all) {
    ObjectDynamics dynamics = read.dynamics;
    const auto even = mass_properties(objects[o].shape);
    if (!even || !(even->volume > 0.0)) read.table.fail("shape", "has no volume to have a mass");
    if (read.density) {
      dynamics.mass = *read.density * even->volume;
      if (dynamics.mass < kLightest || dynamics.mass > kHeaviest) {
        read.table.fail("density_kg_per_m3",
                        fmt::format("makes a mass of {:.3g} g; 0.001 g to 100 kg can move",
                                    dynamics.mass * 1e3));
      }
    }
    if (read.parent) {
      const auto parent = std::ranges::find(objects, *read.parent, &VirtualObject::name);
      if (parent == objects.end()) {
        read.joint->fail("parent", fmt::format("no object is named '{}'", *read.parent));
      }
      dynamics.joint->parent = static_cast<int>(parent - objects.begin());
      if (dynamics.joint->parent == static_cast<int>(o)) {
        read.joint->fail("parent", "an object cannot hang on itself");
      }
    }
    objects[o].dynamics = dynamics;
  }
  for (const auto& [o, read] : all) {
    std::size_t at = o;
    for (std::size_t steps = 0; objects[at].dynamics && objects[at].dynamics->joint; ++steps) {
      const int parent = objects[at].dynamics->joint->parent;
      if (parent < 0) break;
      if (steps > objects.size()) {
        read.joint->fail("parent", "the joints make a loop; one of them must hang on the world");
      }
      at = static_cast<std::size_t>(parent);
    }
  }
}

}  // namespace softfinger
