#include "softfinger/tracking/natnet/natnet_protocol.hpp"

#include <fmt/format.h>

#include <utility>

#include "softfinger/base/error.hpp"
#include "softfinger/wire/byte_order.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kNameSize = 256;  // of a program in SERVERINFO and CONNECT, bytes

NatNetVersion read_version(ByteReader& reader) {
  const NatNetVersion version{reader.u8(), reader.u8()};
  reader.skip(2);
  return version;
}

NatNetDatagram datagram(NatNetMessage message, std::span<const std::uint8_t> payload) {
  ByteWriter writer;
  writer.u16(static_cast<std::uint16_t>(message));
  writer.u16(static_cast<std::uint16_t>(payload.size()));
  writer.append(payload);
  return std::move(writer.bytes());
}

}  // namespace

std::string text_of(NatNetVersion version) {
  return fmt::format("{}.{}", version.major, version.minor);
}

std::optional<NatNetPacket> open_natnet(std::span<const std::uint8_t> datagram) {
  ByteReader reader(datagram);
  const auto message = static_cast<NatNetMessage>(reader.u16());
  const std::size_t size = reader.u16();
  const auto payload = reader.bytes(size);
  if (!reader.ok()) return std::nullopt;
  return NatNetPacket{message, payload};
}

std::optional<NatNetServer> decode_natnet_server(std::span<const std::uint8_t> payload) {
  ByteReader reader(payload);
  ByteReader name(reader.bytes(kNameSize));
  NatNetServer server;
  server.name = in_one_line(std::string(name.text()));
  reader.skip(4);  // version of the program
  server.version = read_version(reader);
  if (!reader.ok()) return std::nullopt;
  if (server.version < kOldestNatNet) return server;  // says no more
  server.ticks_per_second = reader.u64();
  server.data_port = reader.u16();
  server.multicast = reader.u8() != 0;
  for (const std::uint8_t part : reader.bytes(4)) server.group = server.group << 8 | part;
  if (!reader.ok() || server.ticks_per_second == 0) return std::nullopt;
  return server;
}

std::optional<NatNetEcho> decode_natnet_echo(std::span<const std::uint8_t> payload) {
  ByteReader reader(payload);
  NatNetEcho echo;
  echo.stamp = reader.u64();
  echo.ticks = reader.u64();
  if (!reader.ok()) return std::nullopt;
  return echo;
}

NatNetDatagram encode_natnet_connect() {
  ByteWriter payload;
  payload.zeros(kNameSize + 4);
  payload.u8(kNewestNatNet.major);
  payload.u8(kNewestNatNet.minor);
  payload.zeros(2);
  return datagram(NatNetMessage::kConnect, payload.bytes());
}

NatNetDatagram encode_natnet_request(NatNetMessage message, std::string_view text) {
  ByteWriter payload;
  if (!text.empty()) payload.text(text);
  return datagram(message, payload.bytes());
}

NatNetDatagram encode_natnet_echo_request(std::uint64_t stamp) {
  ByteWriter payload;
  payload.u64(stamp);
  return datagram(NatNetMessage::kEchoRequest, payload.bytes());
}

}  // namespace softfinger
