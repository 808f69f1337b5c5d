#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

// OptiTrack's NatNet, versions 3.0 to 4.2, as a client reads it: the layouts of the samples
// PacketClient.cpp and NatNetClient.py of the NatNet SDK and of the open clients natnet_py and
// python-natnet-client. Everything is little-endian; every count is bounded by the bytes left.

struct NatNetVersion {
  std::uint8_t major = 0;
  std::uint8_t minor = 0;

  bool operator==(const NatNetVersion&) const = default;
  friend constexpr std::strong_ordering operator<=>(NatNetVersion a, NatNetVersion b) {
    return a.major != b.major ? a.major <=> b.major : a.minor <=> b.minor;
  }
};
inline constexpr NatNetVersion kOldestNatNet{3, 0};
inline constexpr NatNetVersion kNewestNatNet{4, 2};
/// "4.1".
[[nodiscard]] std::string text_of(NatNetVersion version);

inline constexpr std::uint16_t kNatNetDataPort = 1511;
inline constexpr std::uint32_t kNatNetGroup = 0xefff2a63;  ///< 239.255.42.99

enum class NatNetMessage : std::uint16_t {
  kConnect = 0,
  kServerInfo = 1,
  kRequest = 2,
  kResponse = 3,
  kRequestModels = 4,
  kModels = 5,
  kFrame = 7,
  kKeepAlive = 10,
  kEchoRequest = 12,
  kEchoResponse = 13,
};

/// A datagram taken apart.
struct NatNetPacket {
  NatNetMessage message{};
  std::span<const std::uint8_t> payload;
};
/// None where the header promises more than there is.
[[nodiscard]] std::optional<NatNetPacket> open_natnet(std::span<const std::uint8_t> datagram);

/// What a server says of itself.
struct NatNetServer {
  std::string name;  ///< of its program, e.g. "Motive"
  NatNetVersion version;
  std::uint64_t ticks_per_second = 0;  ///< of the clock of all its stamps
  std::uint16_t data_port = kNatNetDataPort;
  bool multicast = true;
  std::uint32_t group = kNatNetGroup;  ///< IPv4 address, in the processor's byte order
};
[[nodiscard]] std::optional<NatNetServer> decode_natnet_server(
    std::span<const std::uint8_t> payload);

/// A rigid body that a server tracks.
struct NatNetBody {
  std::int32_t id = 0;
  std::string name;
};
/// The rigid bodies of a MODELDEF. What comes after something that cannot be read is left out; none
/// where not even the number of descriptions can be.
[[nodiscard]] std::optional<std::vector<NatNetBody>> decode_natnet_models(
    std::span<const std::uint8_t> payload, NatNetVersion version);

/// What a frame says of one rigid body, and of itself.
struct NatNetFrame {
  std::int32_t number = 0;
  bool has_body = false;               ///< the next three mean something
  bool tracked = false;                ///< the server sees the body
  Vector3 position = Vector3::Zero();  ///< in K, in the server's unit of length
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  std::uint64_t mid_exposure = 0;  ///< when the cameras saw it, in ticks of the server
  bool models_changed = false;
  bool version_changed = false;
};
/// None where the frame breaks the layout of its version.
[[nodiscard]] std::optional<NatNetFrame> decode_natnet_frame(std::span<const std::uint8_t> payload,
                                                             NatNetVersion version,
                                                             std::int32_t body);

/// The answer to an ECHO_REQUEST.
struct NatNetEcho {
  std::uint64_t stamp = 0;  ///< the client's
  std::uint64_t ticks = 0;  ///< of the server, when it received the request
};
[[nodiscard]] std::optional<NatNetEcho> decode_natnet_echo(std::span<const std::uint8_t> payload);

using NatNetDatagram = std::vector<std::uint8_t>;
/// What a client sends.
[[nodiscard]] NatNetDatagram encode_natnet_connect();
/// kRequestModels, kKeepAlive: without text. kRequest: a command such as "Bitstream,4.2".
[[nodiscard]] NatNetDatagram encode_natnet_request(NatNetMessage message,
                                                   std::string_view text = {});
[[nodiscard]] NatNetDatagram encode_natnet_echo_request(std::uint64_t stamp);

}  // namespace softfinger
