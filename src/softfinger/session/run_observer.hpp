#pragma once

#include <functional>
#include <optional>
#include <string>

namespace softfinger {

/// What whoever started a run, or a fit, is told meanwhile.
struct RunObserver {
  /// One line for people, e.g. that the device's port is gone.
  std::function<void(const std::string&)> message;
  /// Time reached (s) and when the run ends (s), if it does.
  std::function<void(double, std::optional<double>)> progress;
};

}  // namespace softfinger
