#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger {

/// OSC message of a force sensor: one number, float32 (`f`) or float64 (`d`).
inline constexpr std::string_view kOscForceAddress = "/force";
/// No line, and no datagram, of a force sensor is longer, bytes.
inline constexpr std::size_t kLongestForceLine = 256;

/// The number of a line: the first one in it that stands by itself, between blanks, commas,
/// semicolons, ':' and '=' ("Reading: -0.52 N"). None where there is none, where it is not finite
/// and where the line is too long.
[[nodiscard]] std::optional<double> decode_force_line(std::string_view line);
/// The last such message of an OSC packet; none where the packet breaks the format.
[[nodiscard]] std::optional<double> decode_force_osc(std::span<const std::uint8_t> packet);

/// With its line feed.
[[nodiscard]] std::string encode_force_line(double reading);
[[nodiscard]] std::vector<std::uint8_t> encode_force_osc(double reading);

/// Lines out of bytes as they come. What is longer than kLongestForceLine is passed over up to the
/// next line feed. Allocates nothing.
class ForceLines {
 public:
  /// Calls take(line) for each line that ends in these bytes.
  template <typename Take>
  void feed(std::span<const std::uint8_t> bytes, const Take& take) {
    for (const std::uint8_t byte : bytes) {
      if (byte == '\n' || byte == '\r') {
        if (!too_long_ && size_ > 0) take(std::string_view(line_, size_));
        size_ = 0;
        too_long_ = false;
      } else if (size_ == kLongestForceLine) {
        too_long_ = true;
      } else {
        line_[size_++] = static_cast<char>(byte);
      }
    }
  }
  /// Bytes before the next line feed are the end of a line whose beginning was lost.
  void begin_within_a_line() {
    size_ = 0;
    too_long_ = true;
  }

 private:
  char line_[kLongestForceLine] = {};
  std::size_t size_ = 0;
  bool too_long_ = false;
};

}  // namespace softfinger
