#include "softfinger/device/device_file.hpp"

#include <utility>

#include "softfinger/device/kinds/device_kinds.hpp"
#include "softfinger/files/config_file.hpp"
#include "softfinger/files/text_file.hpp"

namespace softfinger {

std::shared_ptr<const Device> load_device(const std::filesystem::path& path, double mount_shift) {
  return load_device(path, read_text_file(path, ConfigFile::kMaxSize), mount_shift);
}

std::shared_ptr<const Device> load_device(const std::filesystem::path& path,
                                          const std::string& text, double mount_shift) {
  DeviceSettings settings;
  settings.text = text;
  settings.mount_shift = mount_shift;
  const ConfigFile file(path, text);
  settings.kind = file.root().choice("kind", device_kind_names());
  const DeviceKind& kind = device_kind(settings.kind);
  return kind.read(file, std::move(settings));
}

}  // namespace softfinger
