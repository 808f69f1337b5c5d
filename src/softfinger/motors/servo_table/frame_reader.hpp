#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "softfinger/motors/servo_table/servo_protocol.hpp"

namespace softfinger {

/// Finds the frames in a stream of bytes. What is no frame is counted and skipped, byte by byte, so
/// that a frame after (or inside) a broken one is not lost. Allocates nothing.
class FrameReader {
 public:
  explicit FrameReader(const ServoProtocol& protocol) : protocol_(&protocol) {}

  /// Takes the next bytes of the line and calls `found(const ServoFrame&)` for each frame that is
  /// complete.
  template <typename Found>
  void push(std::span<const std::uint8_t> bytes, const Found& found) {
    for (const std::uint8_t byte : bytes) {
      buffer_[size_++] = byte;
      ++bytes_;
      while (const auto frame = next()) found(*frame);
    }
  }
  /// Forgets a frame that is not complete.
  void reset() { size_ = 0; }

  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Bytes that were part of no frame.
  [[nodiscard]] std::uint64_t malformed_bytes() const { return malformed_; }

 private:
  std::optional<ServoFrame> next();

  const ServoProtocol* protocol_;
  std::array<std::uint8_t, ServoProtocol::kMostBytes> buffer_{};
  std::size_t size_ = 0;
  std::uint64_t bytes_ = 0;
  std::uint64_t frames_ = 0;
  std::uint64_t malformed_ = 0;
};

}  // namespace softfinger
