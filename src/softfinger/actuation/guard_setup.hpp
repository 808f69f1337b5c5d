#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "softfinger/actuation/servo_line.hpp"

namespace softfinger {

/// What a guard process is told at its start: which device it guards, and how.
struct GuardSetup {
  std::filesystem::path device_file;  ///< absolute
  std::string device_text;            ///< of that file, when the loop read it
  double mount_shift = 0.0;           ///< m, see DeviceSettings
  ServoLine::Options line;
  bool wait_for_device = false;
};

/// As one JSON text; numbers keep all their bits.
[[nodiscard]] std::string to_text(const GuardSetup& setup);

/// The device that a text names and how to serve it. Throws InputError for a text that is none of
/// to_text(), and what load_device() throws.
struct GuardedDevice {
  std::shared_ptr<const Device> device;
  GuardSetup setup;
};
[[nodiscard]] GuardedDevice read_guard_setup(std::string_view text);

}  // namespace softfinger
