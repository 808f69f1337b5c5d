#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "softfinger/base/name_table.hpp"
#include "softfinger/tracking/hand_part.hpp"

namespace softfinger {

/// Where tracked poses may come from.
enum class TrackerKind { kScript, kCsv, kPage, kWebXr, kUdp, kOsc, kNatnet };

/// What sends the poses of a tracker.
enum class PoseOrigin {
  kMotion,  ///< nobody: they are known before the run, which ends with them
  kPage,    ///< the live page, or a headset that shows it
  kNetwork  ///< another program, as time passes on the wall
};

struct TrackerRow {
  TrackerKind value;
  std::string_view name;   ///< what stands before a colon
  std::string_view brief;  ///< with what has to be given
  std::string_view form;   ///< with all that may be given
  PoseOrigin origin;
  bool of_body;            ///< a tracked body's, which a registration places on the finger
  std::string_view words;  ///< where its poses come from
};
/// In the order in which people read of them.
inline constexpr std::array<TrackerRow, 7> kTrackers{{
    {TrackerKind::kScript, "script", "script", "script", PoseOrigin::kMotion, false,
     "the scene's waypoints"},
    {TrackerKind::kCsv, "csv", "csv:FILE", "csv:FILE", PoseOrigin::kMotion, true,
     "a file of poses"},
    {TrackerKind::kPage, "page", "page", "page", PoseOrigin::kPage, false,
     "a person at the live page, with pointer and keys"},
    {TrackerKind::kWebXr, "webxr", "webxr", "webxr[:HAND]", PoseOrigin::kPage, true,
     "a hand that a headset sees"},
    {TrackerKind::kUdp, "udp", "udp:PORT", "udp:[ADDRESS:]PORT", PoseOrigin::kNetwork, true,
     "anything that can send a datagram"},
    {TrackerKind::kOsc, "osc", "osc:PORT", "osc:[ADDRESS:]PORT", PoseOrigin::kNetwork, true,
     "anything that speaks Open Sound Control"},
    {TrackerKind::kNatnet, "natnet", "natnet:HOST,body=NAME", "natnet:HOST[:PORT],body=NAME[,...]",
     PoseOrigin::kNetwork, true, "an OptiTrack server: Motive, or its emulator"},
}};
/// Those that are wanted, in brief: "script or csv:FILE", where `last` is "or".
[[nodiscard]] std::string trackers_in_brief(std::string_view last,
                                            bool (*wanted)(const TrackerRow&));

/// Where a NatNet server takes commands, if nothing else is said.
inline constexpr std::uint16_t kNatNetCommandPort = 1510;

/// Which way is up in a tracker's own frame.
enum class UpAxis { kY, kZ };

/// A tracker as a scene file or `--tracker` names it, in a form of kTrackers; for HAND see
/// parse_hand_part.
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
