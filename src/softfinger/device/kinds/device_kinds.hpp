#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/device/device.hpp"
#include "softfinger/files/config_file.hpp"

namespace softfinger {

/// A kind of device: what its files are called, who reads them, what they must say.
struct DeviceKind {
  const char* name;   ///< `kind` of a device file
  const char* words;  ///< for people: "3-RRS thimble"
  /// Asks the file for the kind's keys, builds the device and checks it. The settings come with
  /// their kind.
  std::shared_ptr<const Device> (*read)(const ConfigFile& file, DeviceSettings settings);
  /// What a file must say at least; the schema is what the reader asks of it.
  const char* example;
  /// Of a kind whose files may describe what cannot be built: asks for the same keys.
  DeviceSettings (*read_keys)(const ConfigFile& file, DeviceSettings settings) = nullptr;
  bool cables = false;  ///< its linkage is of cables, and drawn so
};

/// Every kind of device, in the order in which people read of them.
[[nodiscard]] std::span<const DeviceKind> device_kinds();
/// The kind of that name; throws InputError, with the nearest, where there is none.
[[nodiscard]] const DeviceKind& device_kind(const std::string& name);
/// Their names, as `kind` of a device file has them.
[[nodiscard]] std::vector<std::string> device_kind_names();
/// What people call that kind; the name itself where there is none of it.
[[nodiscard]] std::string_view device_kind_words(std::string_view name);

}  // namespace softfinger
