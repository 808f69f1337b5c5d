#include "softfinger/tracking/natnet/natnet_encoding.hpp"

#include <utility>

#include "softfinger/wire/byte_order.hpp"

namespace softfinger {
namespace {

NatNetDatagram packed(NatNetMessage message, ByteWriter& payload) {
  ByteWriter writer;
  writer.u16(static_cast<std::uint16_t>(message));
  writer.u16(static_cast<std::uint16_t>(payload.bytes().size()));
  writer.append(payload.bytes());
  return std::move(writer.bytes());
}

/// A section of a frame: how many, from 4.1 how many bytes, and what.
void write_section(ByteWriter& writer, NatNetVersion version, std::size_t count,
                   ByteWriter content) {
  writer.u32(static_cast<std::uint32_t>(count));
  if (version >= NatNetVersion{4, 1}) {
    writer.u32(static_cast<std::uint32_t>(content.bytes().size()));
  }
  writer.append(content.bytes());
}

void write_body(ByteWriter& writer, const NatNetBodyPose& body, double mean_error) {
  const Eigen::Quaterniond q(body.X_KBody.rotation);
  const Vector3& p = body.X_KBody.translation;
  writer.i32(body.id);
  for (const double number : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}) writer.f32(number);
  writer.f32(mean_error);
  writer.u16(body.tracked ? 1 : 0);
}

ByteWriter marker_sets() {
  ByteWriter content;
  content.text("all");
  content.u32(2);
  content.zeros(2 * 12);
  return content;
}

ByteWriter skeletons() {
  ByteWriter content;
  content.i32(1);
  content.u32(1);
  // Bones have ids of their own, which may be those of rigid bodies.
  write_body(content, {.id = 1, .X_KBody = {Matrix3::Identity(), {9.0, 9.0, 9.0}}}, 0.0);
  return content;
}

ByteWriter assets() {
  ByteWriter content;
  content.i32(1);
  content.u32(1);
  content.zeros(4 + 12 + 16 + 4 + 2);
  content.u32(1);
  content.zeros(4 + 12 + 4 + 2 + 4);
  return content;
}

/// A force plate, or a device, with two channels.
ByteWriter channels() {
  ByteWriter content;
  content.i32(1);
  content.u32(2);
  for (int channel = 0; channel < 2; ++channel) {
    content.u32(3);
    content.zeros(3 * 4);
  }
  return content;
}

ByteWriter blank(std::size_t size) {
  ByteWriter content;
  content.zeros(size);
  return content;
}

ByteWriter description(const NatNetBody& body, NatNetVersion version) {
  ByteWriter content;
  content.text(body.name);
  content.i32(body.id);
  content.i32(-1);    // no parent
  content.zeros(12);  // offset
  if (version >= NatNetVersion{4, 2}) {
    content.zeros(12);
    content.f32(1.0);
  }
  content.u32(0);  // markers
  return content;
}

/// Descriptions that are no rigid body's, by their type.
ByteWriter other_description(std::uint32_t type, NatNetVersion version) {
  ByteWriter content;
  switch (type) {
    case 0:
      content.text("all");
      content.u32(2);
      content.text("one");
      content.text("two");
      break;
    case 2:
      content.text("hand");
      content.i32(1);
      content.u32(1);
      content.append(description({1, "bone"}, version).bytes());
      break;
    case 3:
      content.i32(1);
      content.text("plate");
      content.zeros((2 + 3 + 12 * 12 + 4 * 3 + 2) * 4);
      content.u32(1);
      content.text("Fx");
      break;
    case 4:
      content.i32(1);
      content.text("device");
      content.text("serial");
      content.zeros(2 * 4);
      content.u32(1);
      content.text("channel");
      break;
    default:
      content.text("camera");
      content.zeros(12 + 16);
  }
  return content;
}

void write_description(ByteWriter& writer, std::uint32_t type, ByteWriter content,
                       NatNetVersion version) {
  writer.u32(type);
  if (version >= NatNetVersion{4, 1}) {
    writer.u32(static_cast<std::uint32_t>(content.bytes().size()));
  }
  writer.append(content.bytes());
}

}  // namespace

NatNetDatagram encode_natnet_server(const NatNetServer& server) {
  ByteWriter payload;
  payload.text(server.name.substr(0, 255));
  payload.zeros(256 - payload.bytes().size());
  payload.zeros(4);
  payload.u8(server.version.major);
  payload.u8(server.version.minor);
  payload.zeros(2);
  payload.u64(server.ticks_per_second);
  payload.u16(server.data_port);
  payload.u8(server.multicast ? 1 : 0);
  for (int shift = 24; shift >= 0; shift -= 8) {
    payload.u8(static_cast<std::uint8_t>(server.group >> shift));
  }
  return packed(NatNetMessage::kServerInfo, payload);
}

NatNetDatagram encode_natnet_models(std::span<const NatNetBody> bodies, NatNetVersion version,
                                    bool with_all_kinds) {
  ByteWriter payload;
  const auto others = [&](std::initializer_list<std::uint32_t> types) {
    for (const std::uint32_t type : types) {
      if (with_all_kinds)
        write_description(payload, type, other_description(type, version), version);
    }
  };
  payload.u32(static_cast<std::uint32_t>(bodies.size()) + (with_all_kinds ? 5 : 0));
  others({0, 2, 3});
  for (const NatNetBody& body : bodies) {
    write_description(payload, 1, description(body, version), version);
  }
  others({4, 5});
  return packed(NatNetMessage::kModels, payload);
}

NatNetDatagram encode_natnet_frame(const NatNetFrameContent& frame, NatNetVersion version) {
  const bool all = frame.with_all_sections;
  const auto content = [all](ByteWriter full) { return all ? std::move(full) : ByteWriter(); };
  const std::size_t one = all ? 1 : 0;
  ByteWriter payload;
  payload.i32(frame.number);
  write_section(payload, version, one, content(marker_sets()));
  write_section(payload, version, one, content(blank(12)));  // unlabelled markers
  ByteWriter bodies;
  for (const NatNetBodyPose& body : frame.bodies) write_body(bodies, body, frame.mean_error);
  write_section(payload, version, frame.bodies.size(), std::move(bodies));
  write_section(payload, version, one, content(skeletons()));
  if (version >= NatNetVersion{4, 1}) write_section(payload, version, one, content(assets()));
  write_section(payload, version, one, content(blank(26)));  // labelled markers
  write_section(payload, version, one, content(channels()));
  write_section(payload, version, one, content(channels()));
  payload.zeros(8);  // timecode
  payload.f64(frame.time);
  payload.u64(frame.mid_exposure);
  payload.u64(frame.received);
  payload.u64(frame.transmitted);
  payload.u16(
      static_cast<std::uint16_t>((frame.models_changed ? 2 : 0) + (frame.version_changed ? 8 : 0)));
  payload.u32(0);  // end of data
  return packed(NatNetMessage::kFrame, payload);
}

NatNetDatagram encode_natnet_echo(const NatNetEcho& echo) {
  ByteWriter payload;
  payload.u64(echo.stamp);
  payload.u64(echo.ticks);
  return packed(NatNetMessage::kEchoResponse, payload);
}

NatNetDatagram encode_natnet_response(std::int32_t result) {
  ByteWriter payload;
  payload.i32(result);
  return packed(NatNetMessage::kResponse, payload);
}

}  // namespace softfinger
