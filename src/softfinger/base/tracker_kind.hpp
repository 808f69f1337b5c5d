#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace softfinger {

/// Where tracked poses may come from.
enum class TrackerKind { kScript, kCsv, kPage, kUdp, kOsc };

/// A tracker as a scene file or `--tracker` names it: "script", "csv:FILE", "page",
/// "udp:[ADDRESS:]PORT", "osc:[ADDRESS:]PORT".
struct TrackerSpec {
  TrackerKind kind = TrackerKind::kScript;
  std::string file;                   ///< kCsv: as written
  std::string address = "127.0.0.1";  ///< kUdp, kOsc: own IPv4 address
  std::uint16_t port = 0;             ///< kUdp, kOsc: own
};

/// Throws InputError, without a place, that says what is wrong or lists the known kinds.
[[nodiscard]] TrackerSpec parse_tracker_spec(std::string_view text);

/// Whether poses of this kind come over the network, as time passes on the wall.
[[nodiscard]] bool is_network_tracker(TrackerKind kind);

}  // namespace softfinger
