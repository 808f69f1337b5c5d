#include "softfinger/device/device_file.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "softfinger/base/config_file.hpp"
#include "softfinger/device/device_kinds.hpp"

namespace softfinger {
namespace {

struct DeviceKind {
  const char* name;
  std::shared_ptr<const Device> (*read)(const ConfigFile& file, DeviceSettings settings);
};

constexpr std::array kKinds{
    DeviceKind{"platform_3rrs", read_platform_3rrs},
    DeviceKind{"plate_2dof", read_plate_2dof},
    DeviceKind{"cable_platform", read_cable_platform},
    DeviceKind{"pin_array", read_pin_array},
    DeviceKind{"delta_tactor", read_delta_tactor},
    DeviceKind{"membrane", read_membrane},
    DeviceKind{"roller", read_roller},
};

}  // namespace

std::shared_ptr<const Device> load_device(const std::filesystem::path& path) {
  const ConfigFile file(path);
  std::vector<std::string> names;
  for (const DeviceKind& kind : kKinds) names.emplace_back(kind.name);
  DeviceSettings settings;
  settings.kind = file.root().choice("kind", names);
  const auto found = std::find_if(kKinds.begin(), kKinds.end(), [&](const DeviceKind& kind) {
    return settings.kind == kind.name;
  });
  return found->read(file, std::move(settings));
}

}  // namespace softfinger
