#include "softfinger/device/device_file.hpp"

#include <fmt/core.h>

#include <cmath>
#include <memory>

#include "softfinger/base/config_file.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/platform_3rrs.hpp"

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

MatchingSettings read_matching(const ConfigTable& table) {
  MatchingSettings matching;
  matching.separation_tolerance =
      table.number("separation_tolerance_mm", Range::at_least(0.0), matching.separation_tolerance);
  matching.approach = table.number("approach_mm", Range::at_least(0.0), matching.approach);
  matching.objective = table.choice("objective", {"surface"}, matching.objective);
  return matching;
}

ServoSettings read_servo(const ConfigTable& table) {
  ServoSettings servo;
  servo.channel = table.integer("channel", 0, 23);
  servo.zero = table.number("zero_us", Range::positive());
  servo.per_radian = table.number("us_per_deg");
  if (servo.per_radian == 0.0) table.fail("us_per_deg", "must not be 0: the servo would not move");
  servo.min = table.number("min_us", Range::positive());
  servo.max = table.number("max_us", Range::positive());
  if (servo.min >= servo.max) table.fail("min_us", "must be less than max_us");
  // The Maestro's targets are 14-bit quarters of a microsecond.
  if (servo.max > 4095.75 * us) table.fail("max_us", "must be at most 4095.75, the longest pulse");
  return servo;
}

/// Both ends of the joint limits must be pulses the servo may be sent.
void check_cover(const ConfigTable& table, const ServoSettings& servo, const JointLimits& limits,
                 int leg) {
  for (const double angle : {limits.min[leg], limits.max[leg]}) {
    const double pulse = servo.zero + servo.per_radian * angle;
    if (pulse < servo.min - 1e-12 || pulse > servo.max + 1e-12) {
      table.fail(
          "us_per_deg",
          fmt::format("joint {} at its limit of {:g} degrees needs a pulse of {:g} us, out of "
                      "min_us {:g} to max_us {:g}; widen them or narrow limits.joint_deg",
                      leg + 1, angle / deg, pulse / us, servo.min / us, servo.max / us));
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
    table.fail("servo", fmt::format("{} servos are described; this kind has {}, one a leg in leg "
                                    "order ([[transport.servo]])",
                                    servos.size(), joints));
  }
  for (const ConfigTable& servo : servos) {
    transport.servos.push_back(read_servo(servo));
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

Configuration read_tilt_and_travel(const ConfigTable& table) {
  Configuration q(3);
  q[0] = table.number("pitch_deg", Range::between(-90.0, 90.0), 0.0);
  q[1] = table.number("roll_deg", Range::between(-90.0, 90.0), 0.0);
  q[2] = table.number("travel_mm", Range::any(), 0.0);
  return q;
}

/// Why q is out of the workspace, in words; empty if it is inside.
std::string obstacle(const Platform3rrs& device, const Configuration& q) {
  const double tilt = std::hypot(q[0], q[1]);
  const double max_tilt = device.geometry().max_tilt;
  if (tilt > max_tilt + 1e-9) {
    return fmt::format("tilt of {:.4g} degrees is more than limits.max_tilt_deg {:g}", tilt / deg,
                       max_tilt / deg);
  }
  JointAngles joints;
  if (!device.inverse_kinematics(q, joints)) {
    return "the legs do not reach: no inverse kinematics (check crank_mm, coupler_mm, "
           "neutral_height_mm and the radii)";
  }
  const JointLimits& limits = device.joint_limits();
  for (int leg = 0; leg < 3; ++leg) {
    if (joints[leg] < limits.min[leg] - 1e-9 || joints[leg] > limits.max[leg] + 1e-9) {
      return fmt::format(
          "joint {} would be at {:.2f} degrees, out of limits.joint_deg [{:g}, {:g}]", leg + 1,
          joints[leg] / deg, limits.min[leg] / deg, limits.max[leg] / deg);
    }
  }
  // Length of the crank times a change of joint per change of q, about 1 in a sound design.
  if (std::abs(device.home_determinant()) < 1e-3) return "the platform is singular there";
  if (!device.reachable(q)) return "no way leads there from home without passing a limit";
  return {};
}

std::shared_ptr<const Device> read_platform_3rrs(const ConfigFile& file, DeviceSettings settings) {
  const ConfigTable root = file.root();
  settings.X_FB = read_mount(root.table_or_empty("mount"));

  const ConfigTable lengths = root.table("geometry");
  Platform3rrsGeometry geometry;
  geometry.base_radius = lengths.number("base_radius_mm", Range::positive());
  geometry.platform_radius = lengths.number("platform_radius_mm", Range::positive());
  geometry.crank = lengths.number("crank_mm", Range::positive());
  geometry.coupler = lengths.number("coupler_mm", Range::positive());
  geometry.neutral_height = lengths.number("neutral_height_mm", Range::positive());
  geometry.disk_radius = lengths.number("disk_radius_mm", Range::positive());
  geometry.disk_edge_radius = lengths.number("disk_edge_radius_mm", Range::at_least(0.0), 0.5 * mm);
  if (geometry.disk_edge_radius > std::min(geometry.disk_radius, 1.0 * mm)) {
    lengths.fail("disk_edge_radius_mm",
                 "must be at most 1, half the disk's thickness, and at most disk_radius_mm");
  }

  const ConfigTable home = root.table_or_empty("home");
  settings.home = read_tilt_and_travel(home);

  const ConfigTable limits = root.table("limits");
  const Eigen::VectorXd joint = limits.numbers("joint_deg", 2, Range::between(-180.0, 180.0));
  if (joint[0] >= joint[1]) limits.fail("joint_deg", "must be [least, largest]");
  settings.joint_limits.min = JointAngles::Constant(3, joint[0]);
  settings.joint_limits.max = JointAngles::Constant(3, joint[1]);
  settings.joint_limits.max_rate = limits.number("joint_rate_deg_per_s", Range::positive());
  geometry.max_tilt =
      limits.number("max_tilt_deg", {.min = 0.0, .max = 80.0, .open_min = true}, 30.0 * deg);
  settings.max_force = limits.optional_number("max_force_N", Range::positive()).value_or(0.0);

  settings.matching = read_matching(root.table_or_empty("matching"));
  const ConfigTable retract = root.table_or_empty("retract");
  settings.retracted = read_tilt_and_travel(retract);
  if (const auto transport = root.optional_table("transport")) {
    settings.transport = read_transport(*transport, settings.joint_limits);
  }
  root.finish();

  settings.as_read = file.as_read();
  auto device = std::make_shared<const Platform3rrs>(std::move(settings), geometry);
  const std::string at_home = obstacle(*device, device->home());
  if (!at_home.empty()) home.fail("", "home is out of the workspace: " + at_home);
  const std::string at_retracted = obstacle(*device, device->retracted());
  if (!at_retracted.empty()) {
    retract.fail("", "the retracted pose is out of the workspace: " + at_retracted);
  }
  return device;
}

}  // namespace

std::shared_ptr<const Device> load_device(const std::filesystem::path& path) {
  const ConfigFile file(path);
  DeviceSettings settings;
  settings.kind = file.root().choice("kind", {"platform_3rrs"});
  return read_platform_3rrs(file, std::move(settings));
}

}  // namespace softfinger
