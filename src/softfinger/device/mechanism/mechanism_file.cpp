#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "softfinger/base/units.hpp"
#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/kinds/device_readers.hpp"
#include "softfinger/device/mechanism/mechanism.hpp"
#include "softfinger/device/mechanism/mechanism_tables.hpp"
#include "softfinger/device/surfaces/piece_surface.hpp"
#include "softfinger/device/surfaces/surface_file.hpp"

namespace softfinger {
namespace {

constexpr double kMostSensitive = 1e6;          // rates of coordinates by q, rad and m
constexpr double kLeastHomeDeterminant = 1e-4;  // of d(joints)/dq at home, in units of the length

/// What a reading of the configuration is called in the file.
struct BodyCoordinate {
  const char* name;
  LinkageReading::Kind kind;
  int component;
};
constexpr std::array kBodyCoordinates{
    BodyCoordinate{"roll", LinkageReading::Kind::kRotation, 0},
    BodyCoordinate{"pitch", LinkageReading::Kind::kRotation, 1},
    BodyCoordinate{"yaw", LinkageReading::Kind::kRotation, 2},
    BodyCoordinate{"x", LinkageReading::Kind::kPosition, 0},
    BodyCoordinate{"y", LinkageReading::Kind::kPosition, 1},
    BodyCoordinate{"z", LinkageReading::Kind::kPosition, 2},
};

LinkageReading read_body_coordinate(const ConfigTable& table, const LinkageTables& tables,
                                    const LinkagePlacement& at_guess) {
  std::vector<std::string> names;
  names.reserve(kBodyCoordinates.size());
  for (const BodyCoordinate& coordinate : kBodyCoordinates) names.emplace_back(coordinate.name);
  LinkageReading reading;
  reading.body = read_name(table, "body", tables.bodies, "body");
  if (reading.body == 0) table.fail("body", "the base does not move");
  const std::string name = table.choice("coordinate", names);
  const auto& found =
      *std::find_if(kBodyCoordinates.begin(), kBodyCoordinates.end(),
                    [&](const BodyCoordinate& coordinate) { return name == coordinate.name; });
  reading.kind = found.kind;
  reading.component = found.component;
  reading.reference = at_guess.body[static_cast<std::size_t>(reading.body)];
  return reading;
}

LinkageReading read_joint_coordinate(const ConfigTable& table, const LinkageTables& tables) {
  std::vector<std::string> names;
  for (const NamedJoint& joint : tables.joints) names.push_back(joint.name);
  const NamedJoint& joint =
      tables.joints[static_cast<std::size_t>(read_name(table, "joint", names, "joint"))];
  const bool universal = joint.type == JointType::kUniversal;
  if (!universal && joint.type != JointType::kRevolute && joint.type != JointType::kPrismatic) {
    table.fail("joint",
               "must be revolute, prismatic or universal; name a coordinate of its body "
               "instead");
  }
  LinkageReading reading;
  reading.component = tables.linkage.first_coordinate(joint.body);
  if (universal && table.choice("coordinate", {"first", "second"}) == "second") {
    ++reading.component;
  }
  return reading;
}

/// `[configuration]`: one reading a name, in the file's order. Fills in the settings' axes but for
/// their metric.
std::vector<LinkageReading> read_configuration_axes(const ConfigTable& root,
                                                    const LinkageTables& tables,
                                                    const LinkagePlacement& at_guess,
                                                    DeviceSettings& settings) {
  const ConfigTable configuration = root.table("configuration");
  settings.names_axes = true;
  std::vector<LinkageReading> readings;
  for (const std::string& name : configuration.keys()) {
    const ConfigTable table = configuration.table(name);
    const LinkageReading reading = table.has("joint")
                                       ? read_joint_coordinate(table, tables)
                                       : read_body_coordinate(table, tables, at_guess);
    const bool angle = tables.linkage.is_angle(reading);
    configuration.any_name(name, angle ? "_deg$" : "_mm$");
    if (!name.ends_with(angle ? "_deg" : "_mm")) {
      configuration.fail(name,
                         fmt::format("this coordinate is {}: its name must end in {}",
                                     angle ? "an angle" : "a length", angle ? "_deg" : "_mm"));
    }
    if (readings.size() == kMaxLinkageInputs) {
      configuration.fail(name, fmt::format("more than {} coordinates", kMaxLinkageInputs));
    }
    readings.push_back(reading);
    settings.axes.push_back(angle ? ConfigurationAxis::angle(name, 1.0)
                                  : ConfigurationAxis::length(name));
  }
  if (readings.empty()) {
    configuration.fail("", "names no coordinate; a mechanism has one for each degree of freedom");
  }
  return readings;
}

/// The actuated joints' readings and limits, in the file's order.
std::vector<LinkageReading> read_joints(const ConfigTable& root, const LinkageTables& tables,
                                        DeviceSettings& settings) {
  std::vector<LinkageReading> readings;
  std::vector<const NamedJoint*> actuated;
  for (const NamedJoint& joint : tables.joints) {
    if (!joint.actuated) continue;
    if (!actuated.empty() && joint.type != actuated.front()->type) {
      joint.table.fail("actuated",
                       "motors that turn and motors that slide in one mechanism are "
                       "not supported");
    }
    actuated.push_back(&joint);
    LinkageReading reading;
    reading.component = tables.linkage.first_coordinate(joint.body);
    readings.push_back(reading);
  }
  if (actuated.empty()) root.fail("joint", "no joint has actuated = true: nothing moves it");
  const auto count = static_cast<Eigen::Index>(actuated.size());
  JointLimits& limits = settings.joint_limits;
  limits.min.resize(count);
  limits.max.resize(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    limits.min[k] = actuated[static_cast<std::size_t>(k)]->min;
    limits.max[k] = actuated[static_cast<std::size_t>(k)]->max;
  }
  const bool turns = actuated.front()->type == JointType::kRevolute;
  limits.linear = !turns;
  limits.max_rate = root.table("limits").number(
      turns ? "joint_rate_deg_per_s" : "joint_rate_mm_per_s", Range::positive());
  return readings;
}

std::optional<MechanismDescription::TiltLimit> read_tilt(const ConfigTable& limits,
                                                         const LinkageTables& tables,
                                                         const LinkagePlacement& at_guess) {
  const auto max_tilt =
      limits.optional_number("max_tilt_deg", {.min = 0.0, .max = 80.0, .open_min = true});
  if (const bool has_body = limits.optional_text("tilt_body").has_value();
      has_body != max_tilt.has_value()) {
    limits.fail(has_body ? "tilt_body" : "max_tilt_deg",
                "max_tilt_deg and tilt_body go together; give both or neither");
  }
  if (!max_tilt) return std::nullopt;
  const int body = read_name(limits, "tilt_body", tables.bodies, "body");
  return MechanismDescription::TiltLimit{
      body, at_guess.body[static_cast<std::size_t>(body)].rotation, *max_tilt};
}

/// Closes the loops near the guess and checks that the configuration fits the freedom left.
LinkageAssembly assembled(const ConfigTable& root, const LinkageTables& tables,
                          std::size_t coordinates, std::size_t actuated) {
  LinkageAssembly assembly = assemble(tables.linkage, tables.guess);
  if (assembly.worst_residual > 0.0) {
    const int loop = tables.linkage.equation(assembly.worst_equation).loop;
    tables.loops[static_cast<std::size_t>(loop)].fail(
        "", fmt::format("does not close: {:.4g} mm are left at the best found from the guess; "
                        "check lengths, axes and guesses",
                        assembly.worst_residual / mm));
  }
  const auto freedom = static_cast<std::size_t>(assembly.degrees_of_freedom);
  if (freedom != coordinates) {
    root.fail("configuration",
              fmt::format("{} coordinates, but the mechanism has {} degrees of freedom",
                          coordinates, freedom));
  }
  if (freedom != actuated) {
    root.fail("joint", fmt::format("{} actuated joints, but the mechanism has {} degrees of "
                                   "freedom",
                                   actuated, freedom));
  }
  return assembly;
}

/// How far the surface moves with each coordinate: 1 for lengths that are a body's, the surface's
/// radius for rotations, and what a joint moves at home.
void measure_axes(const MechanismDescription& description, DeviceSettings& settings) {
  LinkageSolution home;
  home.x = description.home;
  if (!description.linkage.complete(description.configuration, home)) return;
  const Linkage& linkage = description.linkage.linkage();
  double radius = 0.0;
  const Vector3 centre = description.surface.front().X_LS.translation;
  for (const SurfacePiece& piece : description.surface) {
    if (piece.body != description.surface.front().body) continue;
    radius = std::max(radius, (piece.X_LS.translation - centre).norm() + extent(piece.shape));
  }
  for (std::size_t k = 0; k < settings.axes.size(); ++k) {
    const LinkageReading& reading = description.configuration[k];
    double& metric = settings.axes[k].metric;
    if (reading.kind == LinkageReading::Kind::kRotation) metric = radius;
    if (reading.kind != LinkageReading::Kind::kJoint) continue;
    LinkageVelocity velocity;
    linkage.velocity(home.placement, home.by_value.col(static_cast<Eigen::Index>(k)), velocity);
    metric = 0.0;
    for (const SurfacePiece& piece : description.surface) {
      const auto body = static_cast<std::size_t>(piece.body);
      const Vector3 arm = home.placement.body[body].rotation * piece.X_LS.translation;
      metric = std::max(metric, (velocity.velocity[body] + velocity.spin[body].cross(arm)).norm() +
                                    radius * velocity.spin[body].norm());
    }
    metric = std::max(metric, 1e-2 * (linkage.is_angle(reading) ? linkage.length() : 1.0));
  }
}

/// The axis that leads the surface: [matching] approach, else the z of a body with a surface.
int find_approach(const ConfigTable& root, const std::vector<LinkageReading>& configuration,
                  const SurfacePiece& first_piece, const DeviceSettings& settings) {
  std::vector<std::string> names;
  for (const ConfigurationAxis& axis : settings.axes) names.push_back(axis.name);
  const ConfigTable matching = root.table_or_empty("matching");
  if (matching.optional_text("approach"))
    return read_name(matching, "approach", names, "coordinate");
  for (std::size_t k = 0; k < configuration.size(); ++k) {
    const LinkageReading& reading = configuration[k];
    if (reading.kind == LinkageReading::Kind::kPosition && reading.component == 2 &&
        reading.body == first_piece.body) {
      return static_cast<int>(k);
    }
  }
  return -1;
}

/// Why q is out of the workspace, in words; empty if it is inside.
std::string mechanism_obstacle(const Mechanism& device, const LinkageTables& tables,
                               const Configuration& q) {
  LinkageSolution solution;
  if (!device.solve(q, solution)) {
    return "the loops do not close there, or only beyond a singularity";
  }
  for (const NamedJoint& joint : tables.joints) {
    if (!joint.actuated) continue;
    const double value = solution.x[tables.linkage.first_coordinate(joint.body)];
    if (value < joint.min - 1e-9 || value > joint.max + 1e-9) {
      const bool turns = joint.type == JointType::kRevolute;
      const double unit = turns ? deg : mm;
      return fmt::format("joint '{}' would be at {:.2f} {}, out of its {} [{:g}, {:g}]",
                         joint.name.substr(0, 60), value / unit, turns ? "degrees" : "mm",
                         turns ? "joint_deg" : "joint_mm", joint.min / unit, joint.max / unit);
    }
  }
  if (!(std::abs(device.scaled_home_determinant()) > kLeastHomeDeterminant)) {
    return "the actuated joints do not hold it there: it is singular";
  }
  if (device.description().tilt &&
      device.tilt(solution) > device.description().tilt->max_tilt + 1e-9) {
    return fmt::format("tilt of {:.4g} degrees is more than limits.max_tilt_deg {:g}",
                       device.tilt(solution) / deg, device.description().tilt->max_tilt / deg);
  }
  if (!device.reachable(q)) return "no way leads there from home without passing a limit";
  return {};
}

/// All that the file says, before it is known whether it fits together.
struct MechanismKeys {
  LinkageTables tables;
  std::vector<SurfacePiece> surface;
  std::vector<LinkageReading> configuration, joints;
  std::optional<MechanismDescription::TiltLimit> tilt;
  int approach_axis = -1;
};

MechanismKeys read_mechanism_keys(const ConfigFile& file, DeviceSettings& settings,
                                  bool load_meshes) {
  const ConfigTable root = file.root();
  MechanismKeys keys{.tables = read_linkage(root)};
  LinkagePlacement at_guess;
  keys.tables.linkage.place(keys.tables.guess, at_guess);
  keys.surface = read_surface(root, keys.tables.bodies, load_meshes);
  keys.configuration = read_configuration_axes(root, keys.tables, at_guess, settings);
  keys.joints = read_joints(root, keys.tables, settings);
  keys.tilt = read_tilt(root.table("limits"), keys.tables, at_guess);
  keys.approach_axis = find_approach(root, keys.configuration, keys.surface.front(), settings);
  read_shared_tables(file, settings);
  return keys;
}

}  // namespace

DeviceSettings read_mechanism_keys(const ConfigFile& file, DeviceSettings settings) {
  static_cast<void>(read_mechanism_keys(file, settings, false));
  return settings;
}

std::shared_ptr<const Device> read_mechanism(const ConfigFile& file, DeviceSettings settings) {
  const ConfigTable root = file.root();
  const MechanismKeys keys = read_mechanism_keys(file, settings, true);
  const LinkageTables& tables = keys.tables;
  const LinkageAssembly assembly =
      assembled(root, tables, keys.configuration.size(), keys.joints.size());
  MechanismDescription description{
      .linkage = ClosedLinkage(tables.linkage, assembly.independent_equations),
      .home = assembly.x,
      .configuration = keys.configuration,
      .joints = keys.joints,
      .surface = keys.surface,
      .tilt = keys.tilt,
      .approach_axis = keys.approach_axis};

  // From where the loops closed to where home is.
  LinkageSolution home;
  home.x = assembly.x;
  if (!description.linkage.complete(keys.configuration, home) ||
      !(home.by_value.cwiseAbs().maxCoeff() < kMostSensitive)) {
    root.fail("configuration",
              "these coordinates do not determine the mechanism near its guess: "
              "some motion leaves all of them as they are");
  }
  if (!description.linkage.follow(keys.configuration, settings.home, home)) {
    root.table_or_empty("home").fail(
        "",
        "home is out of the workspace: the loops do not close there, or only beyond a "
        "singularity");
  }
  description.home = home.x;
  measure_axes(description, settings);
  auto kinematics = std::make_unique<const Mechanism>(settings, std::move(description));
  check_rest_poses(file, settings, [&](const Configuration& q) {
    return mechanism_obstacle(*kinematics, tables, q);
  });
  return std::make_shared<const Device>(std::move(settings), std::move(kinematics),
                                        std::make_unique<const PieceSurface>(keys.surface));
}

}  // namespace softfinger
