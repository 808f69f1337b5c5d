#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace softfinger {

/// Reads numbers from bytes that came from outside, little-endian. Reading past the end gives 0 and
/// makes ok() false for good.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

  std::span<const std::uint8_t> bytes(std::size_t count) {
    if (count > bytes_.size()) {
      ok_ = false;
      bytes_ = {};
      return {};
    }
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  void skip(std::size_t count) { (void)bytes(count); }
  void fail() { skip(bytes_.size() + 1); }
  /// A 32-bit count of things that take at least `size` bytes each; one that does not fit into the
  /// bytes left is no count.
  std::size_t count_of(std::size_t size) {
    const std::size_t count = u32();
    if (count <= left() / size) return count;
    fail();
    return 0;
  }
  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  float f32() { return std::bit_cast<float>(u32()); }
  double f64() { return std::bit_cast<double>(u64()); }
  /// Text up to its NUL, which must be there.
  std::string_view text() {
    std::size_t length = 0;
    while (length < bytes_.size() && bytes_[length] != 0) ++length;
    const auto all = bytes(length + 1);
    if (!ok_) return {};
    return {reinterpret_cast<const char*>(all.data()), length};
  }

 private:
  std::uint64_t number(std::size_t size) {
    const auto taken = bytes(size);
    std::uint64_t value = 0;
    for (std::size_t i = taken.size(); i > 0; --i) value = value << 8 | taken[i - 1];
    return value;
  }

  std::span<const std::uint8_t> bytes_;
  bool ok_ = true;
};

/// Appends numbers to a message, little-endian.
class ByteWriter {
 public:
  [[nodiscard]] std::vector<std::uint8_t>& bytes() { return bytes_; }

  void u8(std::uint8_t value) { bytes_.push_back(value); }
  void u16(std::uint16_t value) { number(value, 2); }
  void u32(std::uint32_t value) { number(value, 4); }
  void u64(std::uint64_t value) { number(value, 8); }
  void i32(std::int32_t value) { u32(static_cast<std::uint32_t>(value)); }
  void f32(double value) { u32(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
  void f64(double value) { u64(std::bit_cast<std::uint64_t>(value)); }
  void zeros(std::size_t count) { bytes_.resize(bytes_.size() + count); }
  void append(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) bytes_.push_back(byte);
  }
  /// With its NUL.
  void text(std::string_view text) {
    for (const char character : text) u8(static_cast<std::uint8_t>(character));
    u8(0);
  }

 private:
  void number(std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i) bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }

  std::vector<std::uint8_t> bytes_;
};

}  // namespace softfinger
