#include "softfinger/export/mcap/crc32.hpp"

#include <array>

namespace softfinger {
namespace {

constexpr std::uint32_t kPolynomial = 0xEDB88320U;

/// What each value of a byte does to the rest.
constexpr std::array<std::uint32_t, 256> kTable = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t rest = byte;
    for (int bit = 0; bit < 8; ++bit) rest = (rest >> 1) ^ ((rest & 1U) != 0 ? kPolynomial : 0U);
    table[byte] = rest;
  }
  return table;
}();

}  // namespace

void Crc32::add(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    state_ = (state_ >> 8) ^ kTable[(state_ ^ byte) & 0xFFU];
  }
}

std::uint32_t crc32_of(std::span<const std::uint8_t> bytes) {
  Crc32 crc;
  crc.add(bytes);
  return crc.value();
}

}  // namespace softfinger
