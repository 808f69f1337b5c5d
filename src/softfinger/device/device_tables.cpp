#include "softfinger/device/device_tables.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

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
    q[k] =
        table.number(axis.name, axis.unit == deg ? Range::between(-90.0, 90.0) : Range::any(), 0.0);
  }
  return q;
}

MatchingSettings read_matching(const ConfigTable& table) {
  MatchingSettings matching;
  matching.separation_tolerance =
      table.number("separation_tolerance_mm", Range::at_least(0.0), matching.separation_tolerance);
  matching.approach = table.number("approach_mm", Range::at_least(0.0), matching.approach);
  matching.objective =
      table.choice("objective", {"surface", "surface_and_force", "stress"}, matching.objective);
  return matching;
}

std::string_view servo_slope(bool linear) { return linear ? "us_per_mm" : "us_per_deg"; }

ServoSettings read_servo(const ConfigTable& table, bool linear) {
  ServoSettings servo;
  const std::string_view slope = servo_slope(linear);
  servo.channel = table.integer("channel", 0, kMostServos - 1);
  servo.zero = table.number("zero_us", Range::positive());
  servo.per_radian = table.number(slope);
  if (servo.per_radian == 0.0) table.fail(slope, "must not be 0: the servo would not move");
  servo.min = table.number("min_us", Range::positive());
  servo.max = table.number("max_us", Range::positive());
  if (servo.min >= servo.max) table.fail("min_us", "must be less than max_us");
  // The Maestro's targets are 14-bit quarters of a microsecond.
  if (servo.max > 4095.75 * us) table.fail("max_us", "must be at most 4095.75, the longest pulse");
  return servo;
}

/// Both ends of the joint limits must be pulses the servo may be sent.
void check_cover(const ConfigTable& table, const ServoSettings& servo, const JointLimits& limits,
                 int joint) {
  for (const double at : {limits.min[joint], limits.max[joint]}) {
    const double pulse = servo.zero + servo.per_radian * at;
    if (pulse < servo.min - 1e-12 || pulse > servo.max + 1e-12) {
      table.fail(
          servo_slope(limits.linear),
          fmt::format("joint {} at its limit of {:g} {} needs a pulse of {:g} us, out of "
                      "min_us {:g} to max_us {:g}; widen them or narrow the joint's limits",
                      joint + 1, at / (limits.linear ? mm : deg), limits.linear ? "mm" : "degrees",
                      pulse / us, servo.min / us, servo.max / us));
    }
  }
}

TransportSettings read_transport(const ConfigTable& table, const JointLimits& limits) {
  TransportSettings transport;
  transport.kind = table.choice("kind", {"maestro"});
  transport.port = table.text("port", "emulator");
  if (transport.port.empty()) table.fail("port", "must be \"emulator\" or a serial port");
  transport.baud = table.integer("baud", 300, 4000000, 115200);
  transport.rate = table.number("rate_Hz", {.min = 0.0, .max = 1000.0, .open_min = true}, 30.0);
  const std::vector<ConfigTable> servos = table.tables("servo");
  const auto joints = static_cast<std::size_t>(limits.min.size());
  if (servos.size() != joints) {
    table.fail("servo", fmt::format("{} servos are described; this device has {}, one a joint in "
                                    "joint order ([[transport.servo]])",
                                    servos.size(), joints));
  }
  for (const ConfigTable& servo : servos) {
    transport.servos.push_back(read_servo(servo, limits.linear));
    const auto leg = transport.servos.size() - 1;
    check_cover(servo, transport.servos.back(), limits, static_cast<int>(leg));
    for (std::size_t other = 0; other < leg; ++other) {
      if (transport.servos[other].channel == transport.servos.back().channel) {
        servo.fail("channel", fmt::format("{} is servo {}'s already",
                                          transport.servos.back().channel, other + 1));
      }
    }
  }
  return transport;
}

ForceSensorSettings read_force_sensor(const ConfigTable& table) {
  ForceSensorSettings sensor;
  sensor.kind = table.choice("kind", {"emulator"});
  sensor.noise = table.number("noise_N", Range::at_least(0.0), 0.0);
  return sensor;
}

}  // namespace

JointLimits read_joint_limits(const ConfigTable& limits, int joints) {
  const Eigen::VectorXd joint = limits.numbers("joint_deg", 2, Range::between(-180.0, 180.0));
  if (joint[0] >= joint[1]) limits.fail("joint_deg", "must be [least, largest]");
  return {JointAngles::Constant(joints, joint[0]), JointAngles::Constant(joints, joint[1]),
          limits.number("joint_rate_deg_per_s", Range::positive())};
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
  settings.X_FB = read_mount(root.table_or_empty("mount"));
  settings.home = read_configuration(root.table_or_empty("home"), settings);
  settings.retracted = read_configuration(root.table_or_empty("retract"), settings);
  settings.max_force =
      root.table_or_empty("limits").optional_number("max_force_N", Range::positive()).value_or(0.0);
  settings.matching = read_matching(root.table_or_empty("matching"));
  if (const auto transport = root.optional_table("transport")) {
    settings.transport = read_transport(*transport, settings.joint_limits);
  }
  if (const auto sensor = root.optional_table("force_sensor")) {
    settings.force_sensor = read_force_sensor(*sensor);
  }
  root.finish();
  settings.as_read = file.as_read();
}

void check_rest_poses(const ConfigFile& file, const Device& device,
                      const std::function<std::string(const Configuration& q)>& obstacle) {
  const std::string at_home = obstacle(device.home());
  if (!at_home.empty()) {
    file.root().table_or_empty("home").fail("", "home is out of the workspace: " + at_home);
  }
  const std::string at_retracted = obstacle(device.retracted());
  if (!at_retracted.empty()) {
    file.root().table_or_empty("retract").fail(
        "", "the retracted pose is out of the workspace: " + at_retracted);
  }
}

std::string axis_obstacle(const Device& device, const Configuration& q) {
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const ConfigurationAxis& axis = device.axes()[static_cast<std::size_t>(k)];
    if (q[k] < axis.min - 1e-9 || q[k] > axis.max + 1e-9) {
      return fmt::format("{} is {:g}, out of [{:g}, {:g}]", axis.name, q[k] / axis.unit,
                         axis.min / axis.unit, axis.max / axis.unit);
    }
  }
  return {};
}

std::string joint_obstacle(const Device& device, const Configuration& q) {
  JointAngles joints;
  if (!device.inverse_kinematics(q, joints)) return {};
  const JointLimits& limits = device.joint_limits();
  for (int joint = 0; joint < joints.size(); ++joint) {
    if (joints[joint] < limits.min[joint] - 1e-9 || joints[joint] > limits.max[joint] + 1e-9) {
      return fmt::format(
          "joint {} would be at {:.2f} degrees, out of limits.joint_deg [{:g}, {:g}]", joint + 1,
          joints[joint] / deg, limits.min[joint] / deg, limits.max[joint] / deg);
    }
  }
  return {};
}

}  // namespace softfinger
