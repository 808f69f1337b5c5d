#include <fmt/core.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "softfinger/device/device_tables.hpp"
#include "softfinger/device/kinds/device_readers.hpp"
#include "softfinger/device/linear_drives.hpp"
#include "softfinger/device/surfaces/piece_surface.hpp"
#include "softfinger/device/surfaces/surface_file.hpp"

namespace softfinger {
namespace {

/// A stroke beyond this is a slip of the pen.
const Range kStroke = Range::between(-1000.0, 1000.0);  // mm

/// `[[drive]]`: the settings' axes, and in which direction each moves the surface.
std::vector<Vector3> read_drives(const ConfigTable& root, DeviceSettings& settings) {
  const std::vector<ConfigTable> tables = root.tables("drive");
  root.needs_one("drive");
  settings.names_axes = true;
  std::vector<Vector3> directions;
  for (const ConfigTable& table : tables) {
    const std::string name = table.text("name");
    table.matches("name", "_mm$");
    if (!name.ends_with("_mm")) table.fail("name", "is of a length: it must end in _mm");
    const bool taken =
        std::any_of(settings.axes.begin(), settings.axes.end(),
                    [&](const ConfigurationAxis& axis) { return axis.name == name; });
    if (taken) table.fail("name", fmt::format("another drive is called '{}'", name.substr(0, 60)));
    const Interval stroke = read_interval(table, "joint_mm", kStroke);
    settings.axes.push_back(ConfigurationAxis::length(name, stroke.min, stroke.max));
    directions.push_back(read_axis(table, "axis", Vector3::UnitZ()));
    if (directions.size() > RigidMotion::kMostAxes) {
      table.fail("", fmt::format("more than {} drives", RigidMotion::kMostAxes));
    }
  }
  if (tables.empty()) root.fail("drive", "nothing moves the surface: give it a [[drive]]");
  Eigen::MatrixXd across(3, static_cast<Eigen::Index>(directions.size()));
  for (std::size_t k = 0; k < directions.size(); ++k) {
    across.col(static_cast<Eigen::Index>(k)) = directions[k];
  }
  constexpr double kLeastVolume = 1e-3;  // of the body that the unit vectors span
  if ((across.transpose() * across).determinant() < kLeastVolume * kLeastVolume) {
    root.fail("drive", "these drives move the surface in directions that are not independent");
  }
  return directions;
}

/// Which drive brings the surface to the finger: `[matching] approach`, else the first that moves
/// it along z rather than across.
int read_approach(const ConfigTable& root, const std::vector<Vector3>& directions,
                  const DeviceSettings& settings) {
  std::vector<std::string> names;
  for (const ConfigurationAxis& axis : settings.axes) names.push_back(axis.name);
  const ConfigTable matching = root.table_or_empty("matching");
  if (matching.optional_text("approach")) return read_name(matching, "approach", names, "drive");
  const auto found = std::find_if(directions.begin(), directions.end(), [](const Vector3& along) {
    return along.z() > 0.5 * std::numbers::sqrt2;
  });
  return found == directions.end() ? -1 : static_cast<int>(found - directions.begin());
}

struct DriveKeys {
  std::vector<Vector3> directions;
  int approach_axis = -1;
  std::vector<SurfacePiece> surface;
};

DriveKeys read_drive_keys(const ConfigFile& file, DeviceSettings& settings, bool load_meshes) {
  const ConfigTable root = file.root();
  DriveKeys keys;
  keys.directions = read_drives(root, settings);
  keys.surface = read_surface(root, {}, load_meshes);
  keys.approach_axis = read_approach(root, keys.directions, settings);
  LinearDrives::set_joint_limits(settings, read_linear_rate(root.table_or_empty("limits")));
  read_shared_tables(file, settings);
  return keys;
}

}  // namespace

DeviceSettings read_linear_drives_keys(const ConfigFile& file, DeviceSettings settings) {
  static_cast<void>(read_drive_keys(file, settings, false));
  return settings;
}

std::shared_ptr<const Device> read_linear_drives(const ConfigFile& file, DeviceSettings settings) {
  DriveKeys keys = read_drive_keys(file, settings, true);
  auto kinematics = std::make_unique<const LinearDrives>(settings, std::move(keys.directions),
                                                         keys.approach_axis);
  check_rest_poses(file, settings,
                   [&](const Configuration& q) { return axis_obstacle(*kinematics, q); });
  return std::make_shared<const Device>(
      std::move(settings), std::move(kinematics),
      std::make_unique<const PieceSurface>(std::move(keys.surface)));
}

}  // namespace softfinger
