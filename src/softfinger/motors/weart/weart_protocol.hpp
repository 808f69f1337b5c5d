#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace softfinger {

// Text protocol of the WEART middleware for TouchDIVER devices, as spoken by WEART's SDK (its
// WeArtMessages and WeArtMessageSerializer): fields separated by ':', messages ended by '~', over
// TCP, by default port 13031.

/// What one client asks of the middleware.
struct WeartRequest {
  enum class Kind : std::uint8_t { kStart, kStop, kForce, kStopForce, kOther };
  Kind kind = Kind::kOther;
  double force = 0.0;   ///< of kForce, normal to the pad
  std::string address;  ///< of kForce and kStopForce: "RIGHT:INDEX"
};

/// "StartFromClient:softfinger:VERSION:TrackType1~".
[[nodiscard]] std::string weart_start();
[[nodiscard]] std::string_view weart_stop();
/// "force:0.800000:0.000000:0.000000:RIGHT:INDEX~" to the front of `out`; returns its length, 0
/// where it does not fit. force from 0 to 1; address: "RIGHT:INDEX".
std::size_t encode_weart_force(double force, std::string_view address, std::span<char> out);
/// "stopForce:RIGHT:INDEX~".
std::size_t encode_weart_stop_force(std::string_view address, std::span<char> out);

/// Reads messages from a stream. Those that are longer than any, or not well formed, are counted
/// and skipped.
class WeartReader {
 public:
  static constexpr std::size_t kLongest = 256;

  /// The message that this byte ends, if it ends a good one.
  std::optional<WeartRequest> push(std::uint8_t byte);
  [[nodiscard]] std::uint64_t malformed() const { return malformed_; }

 private:
  std::array<char, kLongest> text_{};
  std::size_t size_ = 0;
  bool too_long_ = false;
  std::uint64_t malformed_ = 0;
};

}  // namespace softfinger
