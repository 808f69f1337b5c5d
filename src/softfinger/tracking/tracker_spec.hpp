#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "softfinger/tracking/hand_part.hpp"

namespace softfinger {

/// Where tracked poses may come from.
enum class TrackerKind { kScript, kCsv, kPage, kWebXr, kUdp, kOsc, kNatnet };

/// Where a NatNet server takes commands, if nothing else is said.
inline constexpr std::uint16_t kNatNetCommandPort = 1510;

/// Which way is up in a tracker's own frame.
enum class UpAxis { kY, kZ };

/// A tracker as a scene file or `--tracker` names it: "script", "csv:FILE", "page",
/// "webxr[:HAND]" (see parse_hand_part), "udp:[ADDRESS:]PORT", "osc:[ADDRESS:]PORT",
/// "natnet:HOST[:PORT],body=NAME[,...]".
struct TrackerSpec {
  TrackerKind kind = TrackerKind::kScript;
  std::string file;                   ///< kCsv: as written
  HandPart hand = {};                 ///< kWebXr
  std::string address = "127.0.0.1";  ///< kUdp, kOsc: own IPv4 address; kNatnet: the server's name
  std::uint16_t port = 0;             ///< kUdp, kOsc: own; kNatnet: the server's command port
  std::string body;                   ///< kNatnet: name of the rigid body
  UpAxis up = UpAxis::kY;             ///< kNatnet
  double scale = 1.0;                 ///< kNatnet: metres per unit of what it streams
  std::optional<bool> multicast;      ///< kNatnet: empty: as the server says
};

/// Throws InputError, without a place, that says what is wrong or lists the known kinds.
[[nodiscard]] TrackerSpec parse_tracker_spec(std::string_view text);

/// Whether several fingers may follow it: "webxr" and "webxr:SIDE", a whole hand. Throws as
/// parse_tracker_spec.
[[nodiscard]] bool tracks_whole_hand(std::string_view text);

/// The tracker of a scene's finger of that name. Of a whole hand, fingers called thumb, index,
/// middle, ring and pinky follow their like, any other the index finger: "webxr:SIDE-FINGER".
/// Everything else stays as it is. Throws as parse_tracker_spec.
[[nodiscard]] std::string tracker_of_finger(std::string_view text, std::string_view finger_name);

/// Whether poses of this kind come over the network, as time passes on the wall.
[[nodiscard]] bool is_network_tracker(TrackerKind kind);

}  // namespace softfinger
