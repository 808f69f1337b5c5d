#include "softfinger/device/kinds/device_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "softfinger/base/error.hpp"
#include "softfinger/device/kinds/device_readers.hpp"
#include "softfinger/device/mechanism/mechanism_example.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {
namespace {

constexpr std::array kKinds{
    DeviceKind{"platform_3rrs", "3-RRS thimble", read_platform_3rrs, R"toml(
[geometry]
base_radius_mm = 12.0
platform_radius_mm = 12.0
crank_mm = 12.0
coupler_mm = 24.0
neutral_height_mm = 28.0
disk_radius_mm = 8.0
[limits]
joint_deg = [-30.0, 75.0]
joint_rate_deg_per_s = 400.0
)toml"},
    DeviceKind{"plate_2dof", "2-DoF plate", read_plate_2dof, R"toml(
[geometry]
lever_mm = 6.0
pinion_radius_mm = 6.0
disk_radius_mm = 8.0
[limits]
joint_deg = [-60.0, 100.0]
joint_rate_deg_per_s = 400.0
)toml"},
    DeviceKind{"cable_platform", "cable-driven platform", read_cable_platform, R"toml(
[geometry]
base_radius_mm = 14.0
platform_radius_mm = 11.0
neutral_height_mm = 24.0
winch_radius_mm = 5.0
spring_length_mm = 32.0
spring_N_per_mm = 0.05
disk_radius_mm = 8.0
[limits]
joint_deg = [-120.0, 150.0]
joint_rate_deg_per_s = 400.0
)toml",
               nullptr, true},
    DeviceKind{"pin_array", "pin array", read_pin_array, R"toml(
[geometry]
rows = 16
columns = 16
pitch_mm = 2.0
pin_radius_mm = 0.5
stroke_mm = 2.0
)toml"},
    DeviceKind{"delta_tactor", "delta tactor", read_delta_tactor, R"toml(
[geometry]
base_radius_mm = 12.0
platform_radius_mm = 4.0
crank_mm = 10.0
forearm_mm = 20.0
neutral_height_mm = 17.0
tip_radius_mm = 3.0
[limits]
joint_deg = [-40.0, 100.0]
joint_rate_deg_per_s = 400.0
)toml"},
    DeviceKind{"membrane", "membrane", read_membrane, R"toml(
[geometry]
ring_radius_mm = 7.0
[limits]
height_mm = [0.0, 4.0]
)toml"},
    DeviceKind{"roller", "roller", read_roller, R"toml(
[geometry]
roller_radius_mm = 5.0
roller_length_mm = 10.0
[limits]
position_mm = [-6.0, 6.0]
height_mm = [-4.0, 7.0]
)toml"},
    DeviceKind{"linear_drives", "linear drives", read_linear_drives, R"toml(
[[drive]]
name = "travel_mm"
axis = [0.0, 0.0, 1.0]
joint_mm = [-3.0, 3.0]
[[surface]]
type = "disk"
radius_mm = 8.0
[[surface]]
type = "sphere"
radius_mm = 8.0
[[surface]]
type = "capsule"
radius_mm = 4.0
length_mm = 8.0
[[surface]]
type = "box"
size_mm = [4.0, 4.0, 4.0]
[[surface]]
type = "pins"
radius_mm = 0.5
rows = 2
columns = 2
pitch_mm = 2.0
[[surface]]
type = "pins"
radius_mm = 0.5
[[surface.pin]]
position_mm = [0.0, 0.0, 0.0]
[[surface]]
type = "mesh"
file = "cap.stl"
unit = "mm"
[[surface]]
type = "mesh"
file = "cap.glb"
unit = "m"
[home]
travel_mm = 0.0
[matching]
approach = "travel_mm"
)toml",
               read_linear_drives_keys},
    DeviceKind{"mechanism", "mechanism", read_mechanism, kMechanismExample, read_mechanism_keys},
};

const DeviceKind* found(std::string_view name) {
  const auto* const kind =
      std::find_if(kKinds.begin(), kKinds.end(),
                   [&](const DeviceKind& candidate) { return name == candidate.name; });
  return kind == kKinds.end() ? nullptr : kind;
}

}  // namespace

std::span<const DeviceKind> device_kinds() { return kKinds; }

const DeviceKind& device_kind(const std::string& name) {
  if (const DeviceKind* kind = found(name)) return *kind;
  const std::string near = nearest_word(name, device_kind_names());
  throw InputError(fmt::format("unknown kind '{}'; {}expected one of: {}", name,
                               near.empty() ? "" : fmt::format("did you mean '{}'? ", near),
                               fmt::join(device_kind_names(), ", ")));
}

std::vector<std::string> device_kind_names() {
  std::vector<std::string> names;
  names.reserve(kKinds.size());
  for (const DeviceKind& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

std::string_view device_kind_words(std::string_view name) {
  const DeviceKind* kind = found(name);
  return kind != nullptr ? kind->words : name;
}

}  // namespace softfinger
