#include "softfinger/device/device_tables.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "softfinger/base/units.hpp"
#include "softfinger/motors/servo_map.hpp"
#include "softfinger/motors/transport_file.hpp"

namespace softfinger {
namespace {

const Range kComponent = Range::between(-1e3, 1e3);  // of an axis

Pose read_mount(const ConfigTable& mount) {
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  Pose X_FB;
  X_FB.translation = mount.numbers("translation_mm", 3, Range::any(), none);
  X_FB.rotation =
      exp_rotation(Vector3(mount.numbers("rotation_vector_deg", 3, Range::any(), none)));
  if (mount.choice("on", {"distal", "middle"}, "distal") == "middle") {
    mount.fail("on",
               "needs a tracker that gives both bones, which none does yet; write \"distal\"");
  }
  return X_FB;
}

/// q by the names of the axes, 0 where not given.
Configuration read_configuration(const ConfigTable& table, const DeviceSettings& settings) {
  const auto count = static_cast<Eigen::Index>(settings.axes.size());
  Configuration q(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const ConfigurationAxis& axis = settings.axes[static_cast<std::size_t>(k)];
    q[k] = table.number(axis.name, axis.angular ? Range::between(-90.0, 90.0) : Range::any(), 0.0);
    if (settings.names_axes) table.any_name(axis.name, axis.angular ? "_deg$" : "_mm$");
  }
  return q;
}

MatchingSettings read_matching(const ConfigTable& table) {
  MatchingSettings matching;
  matching.separation_tolerance =
      table.number("separation_tolerance_mm", Range::at_least(0.0), matching.separation_tolerance);
  matching.approach = table.number("approach_mm", Range::at_least(0.0), matching.approach);
  matching.objective =
      present_objective(table.choice("objective", objective_words(), matching.objective));
  EasingRates& easing = matching.easing;
  const auto read = [&](std::string_view key, double& rate) {
    rate = table.number(key, Range::positive(), rate);
  };
  read("turn_on_skin_deg_per_s", easing.turn_on_skin);
  read("turn_off_skin_deg_per_s", easing.turn_off_skin);
  read("move_off_skin_mm_per_s", easing.move_off_skin);
  read("turn_by_force_deg_per_s", easing.turn_by_force);
  read("move_by_force_mm_per_s", easing.move_by_force);
  return matching;
}

MotorStatics read_statics(const ConfigTable& table, bool linear) {
  const auto number = [&](const char* turning, const char* sliding) {
    return table.optional_number(linear ? sliding : turning, Range::at_least(0.0)).value_or(0.0);
  };
  MotorStatics statics;
  statics.holding = number("torque_N_mm", "force_N");
  statics.compliance = number("compliance_deg_per_N_mm", "compliance_mm_per_N");
  statics.backlash = number("backlash_deg", "backlash_mm");
  if (!(statics.holding > 0.0 || statics.compliance > 0.0 || statics.backlash > 0.0)) {
    table.fail("", fmt::format("says nothing; give {}, or leave it out",
                               linear ? "force_N, compliance_mm_per_N or backlash_mm"
                                      : "torque_N_mm, compliance_deg_per_N_mm or backlash_deg"));
  }
  return statics;
}

constexpr double kLongestPress = 120.0;  ///< s, where the file says nothing
/// Of the joints' range; what loads, friction and slack of servos make is less.
constexpr double kFollowingError = 0.2;
/// Steps of the wire: less is noise of what servos say.
constexpr double kFollowingNoise = 8.0;

/// After joint limits and transport.
void read_supervision(const ConfigTable& limits, DeviceSettings& settings) {
  const JointLimits& joints = settings.joint_limits;
  settings.press_time =
      limits.optional_number("max_press_s", Range::positive()).value_or(kLongestPress);
  double noise = 0.0;
  if (settings.transport && !settings.transport->follows_travel) {
    for (const ServoSettings& servo : settings.transport->servos) {
      noise = std::max(noise, kFollowingNoise * ServoMap(servo).resolution());
    }
  }
  const std::string_view key = joints.linear ? "following_error_mm" : "following_error_deg";
  const auto error = limits.optional_number(key, Range::positive());
  const double unit = joints.linear ? mm : deg;
  if (error && *error < noise) {
    limits.fail(key,
                fmt::format("{:g} is less than the noise of what these servos say; at least {:.3g}",
                            *error / unit, noise / unit));
  }
  const double range = joints.min.size() > 0 ? (joints.max - joints.min).maxCoeff() : 0.0;
  settings.following_error = error.value_or(std::max(noise, kFollowingError * range));
}

}  // namespace

JointLimits read_joint_limits(const ConfigTable& limits, int joints) {
  const Eigen::VectorXd joint = limits.numbers("joint_deg", 2, Range::between(-180.0, 180.0));
  if (joint[0] >= joint[1]) limits.fail("joint_deg", "must be [least, largest]");
  return {.min = JointAngles::Constant(joints, joint[0]),
          .max = JointAngles::Constant(joints, joint[1]),
          .max_rate = limits.number("joint_rate_deg_per_s", Range::positive())};
}

Interval read_interval(const ConfigTable& limits, std::string_view name, Range range) {
  const Eigen::VectorXd ends = limits.numbers(name, 2, range);
  if (ends[0] >= ends[1]) limits.fail(name, "must be [least, largest]");
  return {ends[0], ends[1]};
}

double read_linear_rate(const ConfigTable& limits) {
  return limits.number("joint_rate_mm_per_s", Range::positive(), 50.0 * mm);
}

double read_disk_edge_radius(const ConfigTable& geometry, double disk_radius) {
  const double radius =
      geometry.number("disk_edge_radius_mm", Range::at_least(0.0), std::min(0.5 * mm, disk_radius));
  if (radius > std::min(disk_radius, 1.0 * mm)) {
    geometry.fail("disk_edge_radius_mm",
                  "must be at most 1, half the disk's thickness, and at most disk_radius_mm");
  }
  return radius;
}

double read_max_tilt(const ConfigTable& limits) {
  return limits.number("max_tilt_deg", {.min = 0.0, .max = 80.0, .open_min = true}, 30.0 * deg);
}

void read_shared_tables(const ConfigFile& file, DeviceSettings& settings) {
  const ConfigTable root = file.root();
  const ConfigTable mount = root.table_or_empty("mount");
  settings.X_FB = read_mount(mount);
  settings.X_FB.translation -= settings.mount_shift * settings.X_FB.rotation.col(2);
  settings.clearance = mount.optional_number("clearance_mm", Range::at_least(0.0));
  settings.home = read_configuration(root.table_or_empty("home"), settings);
  settings.retracted = read_configuration(root.table_or_empty("retract"), settings);
  settings.max_force =
      root.table_or_empty("limits").optional_number("max_force_N", Range::positive()).value_or(0.0);
  JointLimits& joints = settings.joint_limits;
  const char* acceleration =
      joints.linear ? "joint_acceleration_mm_per_s2" : "joint_acceleration_deg_per_s2";
  joints.max_acceleration = root.table_or_empty("limits")
                                .optional_number(acceleration, Range::positive())
                                .value_or(joints.max_acceleration);
  settings.matching = read_matching(root.table_or_empty("matching"));
  if (const auto transport = root.optional_table("transport")) {
    settings.transport = read_transport(*transport, settings.joint_limits);
  }
  read_supervision(root.table_or_empty("limits"), settings);
  if (const auto statics = root.optional_table("statics")) {
    settings.statics = read_statics(*statics, joints.linear);
  }
  if (const auto sensor = root.optional_table("force_sensor")) {
    settings.force_sensor = read_force_sensor(*sensor);
  }
  root.finish();
  settings.as_read = file.as_read();
}

void check_rest_poses(const ConfigFile& file, const DeviceSettings& settings,
                      const std::function<std::string(const Configuration& q)>& obstacle) {
  const std::string at_home = obstacle(settings.home);
  if (!at_home.empty()) {
    file.root().table_or_empty("home").fail("", "home is out of the workspace: " + at_home);
  }
  const std::string at_retracted = obstacle(settings.retracted);
  if (!at_retracted.empty()) {
    file.root().table_or_empty("retract").fail(
        "", "the retracted pose is out of the workspace: " + at_retracted);
  }
}

std::string axis_obstacle(const Kinematics& kinematics, const Configuration& q) {
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const ConfigurationAxis& axis = kinematics.axes()[static_cast<std::size_t>(k)];
    if (q[k] < axis.min - 1e-9 || q[k] > axis.max + 1e-9) {
      return fmt::format("{} is {:g}, out of [{:g}, {:g}]", axis.name, q[k] / axis.unit(),
                         axis.min / axis.unit(), axis.max / axis.unit());
    }
  }
  return {};
}

std::string joint_obstacle(const Kinematics& kinematics, const Configuration& q) {
  JointAngles joints;
  if (!kinematics.inverse_kinematics(q, joints)) return {};
  const JointLimits& limits = kinematics.joint_limits();
  for (int joint = 0; joint < joints.size(); ++joint) {
    if (joints[joint] < limits.min[joint] - 1e-9 || joints[joint] > limits.max[joint] + 1e-9) {
      return fmt::format(
          "joint {} would be at {:.2f} degrees, out of limits.joint_deg [{:g}, {:g}]", joint + 1,
          joints[joint] / deg, limits.min[joint] / deg, limits.max[joint] / deg);
    }
  }
  return {};
}

int read_name(const ConfigTable& table, const std::string& key,
              const std::vector<std::string>& names, const std::string& what) {
  const std::string name = table.text(key);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    const std::string nearest = nearest_word(name, names);
    table.fail(key, fmt::format("no {} is called '{}'{}", what, name.substr(0, 60),
                                nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
  return static_cast<int>(found - names.begin());
}

Pose read_frame(const ConfigTable& table, const std::string& suffix) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(3);
  Pose pose;
  pose.translation = table.numbers("origin" + suffix + "_mm", 3, kPlaceRange, none);
  pose.rotation = exp_rotation(
      Vector3(table.numbers("rotation_vector" + suffix + "_deg", 3, kTurnRange, none)));
  return pose;
}

Vector3 read_axis(const ConfigTable& table, const std::string& key, const Vector3& fallback) {
  const Vector3 axis = table.numbers(key, 3, kComponent, fallback);
  if (!(axis.norm() > 1e-6)) table.fail(key, "must have a direction, found a vector of length 0");
  return axis.normalized();
}

}  // namespace softfinger
