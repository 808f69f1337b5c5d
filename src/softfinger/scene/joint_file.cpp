#include "softfinger/scene/joint_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

const Range kAxis = Range::between(-1e6, 1e6);
const Range kPoint = Range::between(-1e5, 1e5);    // mm
const Range kValue = Range::between(-1e6, 1e6);    // mm, deg
const Range kConstant = Range::between(0.0, 1e6);  // of springs, dampers and friction
const Range kForce = Range::between(-1e4, 1e4);    // N
constexpr int kMostPoints = 200;
constexpr int kMostDetents = 1000;

/// Keys of a joint with one coordinate, by the unit of that.
struct CoordinateKeys {
  std::string_view limits, spring, rest, damping, friction;
};
constexpr CoordinateKeys kSliderKeys{"limits_mm", "spring_N_per_mm", "rest_mm",
                                     "damping_N_s_per_mm", "friction_N"};
constexpr CoordinateKeys kHingeKeys{"limits_deg", "spring_N_mm_per_rad", "rest_deg",
                                    "damping_N_mm_s_per_rad", "friction_N_mm"};

/// Keys that not every kind of joint has.
struct KeyOfKinds {
  std::string_view key;
  bool slider, hinge, ball;
};
constexpr std::array<KeyOfKinds, 14> kKeysOfKinds{{
    {"axis", true, true, false},
    {"point_mm", true, true, true},
    {kSliderKeys.limits, true, false, false},
    {kSliderKeys.spring, true, false, false},
    {kSliderKeys.rest, true, false, false},
    {kSliderKeys.damping, true, false, false},
    {kSliderKeys.friction, true, false, false},
    {"curve", true, false, false},
    {kHingeKeys.limits, false, true, false},
    {kHingeKeys.spring, false, true, false},
    {kHingeKeys.rest, false, true, false},
    {kHingeKeys.damping, false, true, false},
    {kHingeKeys.friction, false, true, false},
    {"detents", false, true, false},
}};

bool has_key(const KeyOfKinds& row, JointKind kind) {
  return (kind == JointKind::kSlider && row.slider) || (kind == JointKind::kHinge && row.hinge) ||
         (kind == JointKind::kBall && row.ball);
}

/// A key of another kind is not misspelt: it is told whose it is.
void refuse_keys_of_others(const ConfigTable& table, JointKind kind) {
  for (const KeyOfKinds& row : kKeysOfKinds) {
    if (!table.has(row.key) || has_key(row, kind)) continue;
    std::vector<std::string> owners;
    for (const auto& each : kJointKinds) {
      if (has_key(row, each.value)) owners.emplace_back(each.name);
    }
    table.fail(row.key, fmt::format("is of a joint of kind {}, not {}", listed(owners, "or"),
                                    row_of(kJointKinds, kind).name));
  }
}

Vector3 read_axis(const ConfigTable& table) {
  const Vector3 axis = table.numbers("axis", 3, kAxis);
  if (!(axis.norm() > 1e-6)) table.fail("axis", "must have a direction, found zero");
  return axis.normalized();
}

/// The joint is at 0 in the beginning, and what it rests at is to be reached.
void read_limits(const ConfigTable& table, const CoordinateKeys& keys, Joint& joint) {
  const auto limits = table.optional_numbers(keys.limits, 2, kValue);
  if (!limits) return;
  const double unit = unit_scale(keys.limits);
  const double low = (*limits)[0];
  const double high = (*limits)[1];
  if (!(low < high)) {
    table.fail(keys.limits, fmt::format("the first must be less than the second, found {:.6g} and "
                                        "{:.6g}",
                                        low / unit, high / unit));
  }
  if (low > 0.0 || high < 0.0) {
    table.fail(keys.limits, fmt::format("must have 0 between them, where the joint is at the "
                                        "start, found {:.6g} and {:.6g}",
                                        low / unit, high / unit));
  }
  if (joint.rest < low || joint.rest > high) {
    table.fail(keys.rest, fmt::format("must lie within {}, {:.6g} to {:.6g}, found {:.6g}",
                                      keys.limits, low / unit, high / unit, joint.rest / unit));
  }
  joint.limits = {low, high};
}

JointCurve read_curve(const ConfigTable& table) {
  const Eigen::VectorXd travel = table.some_numbers("travel_mm", 2, kMostPoints, kPoint);
  const Eigen::VectorXd force = table.some_numbers("force_N", 2, kMostPoints, kForce);
  if (force.size() != travel.size()) {
    table.fail("force_N", fmt::format("expected {} numbers, one for each of travel_mm, found {}",
                                      travel.size(), force.size()));
  }
  for (Eigen::Index i = 1; i < travel.size(); ++i) {
    if (travel[i] - travel[i - 1] > 1e-9) continue;
    table.fail("travel_mm", fmt::format("must increase, found {:.6g} after {:.6g}", travel[i] / mm,
                                        travel[i - 1] / mm));
  }
  return {.travel = {travel.begin(), travel.end()}, .force = {force.begin(), force.end()}};
}

JointDetents read_detents(const ConfigTable& table) {
  return {.count = table.integer("count", 1, kMostDetents),
          .torque = table.number("torque_N_mm", kConstant)};
}

void read_coordinate(const ConfigTable& table, const CoordinateKeys& keys, Joint& joint) {
  joint.axis_O = read_axis(table);
  joint.point_O = table.numbers("point_mm", 3, kPoint, Vector3::Zero());
  joint.rest = table.number(keys.rest, kValue, 0.0);
  read_limits(table, keys, joint);
  joint.spring = table.number(keys.spring, kConstant, 0.0);
  joint.damping = table.number(keys.damping, kConstant, 0.0);
  joint.friction = table.number(keys.friction, kConstant, 0.0);
}

}  // namespace

Joint read_joint(const ConfigTable& table) {
  Joint joint;
  joint.kind = row_named(kJointKinds, table.choice("kind", names_of(kJointKinds)))->value;
  table.decides("kind");
  refuse_keys_of_others(table, joint.kind);
  if (joint.kind == JointKind::kSlider) {
    read_coordinate(table, kSliderKeys, joint);
    if (const auto curve = table.optional_table("curve")) {
      if (table.has(kSliderKeys.spring)) {
        table.fail("curve", fmt::format("stands instead of {}; leave one out", kSliderKeys.spring));
      }
      joint.curve = read_curve(*curve);
    }
  } else if (joint.kind == JointKind::kHinge) {
    read_coordinate(table, kHingeKeys, joint);
    if (const auto detents = table.optional_table("detents"))
      joint.detents = read_detents(*detents);
  } else if (joint.kind == JointKind::kBall) {
    joint.point_O = table.numbers("point_mm", 3, kPoint, Vector3::Zero());
  }
  return joint;
}

}  // namespace softfinger
