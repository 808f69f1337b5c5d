#pragma once

#include <string>

namespace softfinger {

/// A port of this machine with an emulated bus behind it, in wall time.
class EmulatorPort {
 public:
  EmulatorPort() = default;
  virtual ~EmulatorPort() = default;
  EmulatorPort(const EmulatorPort&) = delete;
  EmulatorPort& operator=(const EmulatorPort&) = delete;

  /// What to open: the name of a tty, or host:port.
  [[nodiscard]] virtual const std::string& port() const = 0;
};

}  // namespace softfinger
