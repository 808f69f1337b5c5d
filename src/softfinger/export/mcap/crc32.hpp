#pragma once

#include <cstdint>
#include <span>

namespace softfinger {

/// CRC-32 of IEEE 802.3 (reflected polynomial 0xEDB88320), bytes after bytes.
class Crc32 {
 public:
  void add(std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::uint32_t value() const { return ~state_; }

 private:
  std::uint32_t state_ = 0xFFFFFFFFU;
};

[[nodiscard]] std::uint32_t crc32_of(std::span<const std::uint8_t> bytes);

}  // namespace softfinger
