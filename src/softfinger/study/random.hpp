#pragma once

#include <cstdint>
#include <random>

namespace softfinger {

/// Even in [0, 1), the same numbers with any standard library.
class UnitRandom {
 public:
  explicit UnitRandom(std::uint64_t seed) : random_(seed) {}
  [[nodiscard]] double next() { return static_cast<double>(random_() >> 11) * 0x1.0p-53; }
  /// Whole, even in [0, count); count > 0.
  [[nodiscard]] std::size_t below(std::size_t count) {
    return static_cast<std::size_t>(next() * static_cast<double>(count));
  }
  [[nodiscard]] std::uint64_t bits() { return random_(); }

 private:
  std::mt19937_64 random_;
};

}  // namespace softfinger
