#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "softfinger/wire/byte_order.hpp"

namespace softfinger {

/// A message as ROS 2 has it on the wire and in files: plain CDR, little-endian (OMG DDS
/// Interoperability Wire Protocol 2.3, section 10). A number is aligned to its size, counted from
/// behind the four bytes that say which encoding it is.
class CdrWriter {
 public:
  CdrWriter() { bytes_.bytes() = {0x00, 0x01, 0x00, 0x00}; }

  [[nodiscard]] std::span<const std::uint8_t> bytes() { return bytes_.bytes(); }

  void u8(std::uint8_t value) { bytes_.u8(value); }
  void u32(std::uint32_t value) {
    align(4);
    bytes_.u32(value);
  }
  void i32(std::int32_t value) { u32(static_cast<std::uint32_t>(value)); }
  void f64(double value) {
    align(8);
    bytes_.f64(value);
  }
  void text(std::string_view text) {
    u32(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.text(text);
  }
  /// Of a sequence whose elements follow.
  void count(std::size_t elements) { u32(static_cast<std::uint32_t>(elements)); }
  void append(std::span<const std::uint8_t> bytes) { bytes_.append(bytes); }

 private:
  void align(std::size_t size) {
    while ((bytes_.bytes().size() - 4) % size != 0) bytes_.u8(0);
  }

  ByteWriter bytes_;
};

}  // namespace softfinger
