#pragma once

#include <cstdint>

namespace softfinger {

/// Servos of a device that cannot be led: bit i is servo i, in the order of the device file.
/// Aligned so that it passes between threads without a lock.
struct alignas(8) ServoFaults {
  std::uint32_t silent = 0;  ///< do not answer
  std::uint32_t limp = 0;    ///< have lost their torque, or protect themselves

  [[nodiscard]] std::uint32_t any() const { return silent | limp; }
  [[nodiscard]] bool has(std::size_t servo) const { return ((any() >> servo) & 1U) != 0; }
  bool operator==(const ServoFaults&) const = default;
};

/// What a servo says of itself that must not go on, bits; it can be led all the same.
enum ServoComplaint : std::uint8_t {
  kBadVoltage = 1 << 0,
  kTooHot = 1 << 1,
  kOverload = 1 << 2,  ///< more current or torque than it bears
  kDefect = 1 << 3,    ///< of its sensor or its electronics
  kBadLine = 1 << 4,   ///< what it was sent came spoilt, in part, or not for too long
};

}  // namespace softfinger
