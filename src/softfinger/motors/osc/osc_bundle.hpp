#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace softfinger {

/// An OSC message with one float32.
struct OscFloat {
  std::string_view address;  ///< "/..."
  float value = 0.0F;
};

/// Bytes of a bundle with these messages ("The Open Sound Control 1.0 Specification", 2002).
[[nodiscard]] std::size_t osc_bundle_size(std::span<const OscFloat> messages);
/// Writes the bundle, time tag "immediately", to the front of `out`, which must have room.
std::size_t encode_osc_bundle(std::span<const OscFloat> messages, std::span<std::uint8_t> out);

/// The messages of a bundle in which every element is a message with one float32; nothing where the
/// packet is anything else or breaks the format. Addresses point into `packet`.
[[nodiscard]] std::optional<std::vector<OscFloat>> decode_osc_bundle(
    std::span<const std::uint8_t> packet);

}  // namespace softfinger
