#pragma once

#include <optional>

namespace softfinger {

/// How much of its processors' time a virtual machine was not given, from when this was made on:
/// what makes a loop late there and no program can help.
class StolenTime {
 public:
  StolenTime();
  /// Share in [0, 1]; empty where the system does not say.
  [[nodiscard]] std::optional<double> share() const;

 private:
  struct Ticks {
    double all = 0.0;
    double stolen = 0.0;
  };
  [[nodiscard]] static std::optional<Ticks> now();

  std::optional<Ticks> began_;
};

}  // namespace softfinger
