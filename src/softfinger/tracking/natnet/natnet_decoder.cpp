#include <utility>

#include "softfinger/tracking/natnet/natnet_protocol.hpp"
#include "softfinger/wire/byte_order.hpp"

namespace softfinger {
namespace {

constexpr NatNetVersion kNamedMarkers{4, 0};   // marker names in descriptions of rigid bodies
constexpr NatNetVersion kSizedSections{4, 1};  // sections say how many bytes they are
constexpr NatNetVersion kBodyOrientation{4, 2};

constexpr std::size_t kPoint = 12;           // bytes: 3 x f32
constexpr std::size_t kRigidBody = 38;       // id, position, rotation, error, flags
constexpr std::size_t kLabelledMarker = 26;  // id, position, size, flags, residual
constexpr std::size_t kStamps = 24;

constexpr std::uint16_t kTracked = 1;        // flag of a rigid body
constexpr std::uint16_t kModelsChanged = 2;  // flags of a frame
constexpr std::uint16_t kVersionChanged = 8;

Vector3 read_point(ByteReader& reader) {
  const double x = reader.f32();
  const double y = reader.f32();
  const double z = reader.f32();
  return {x, y, z};
}

void read_bodies(ByteReader& reader, std::size_t count, std::int32_t wanted, NatNetFrame& frame) {
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    const std::int32_t id = reader.i32();
    if (id != wanted || frame.has_body) {
      reader.skip(kRigidBody - 4);
      continue;
    }
    frame.position = read_point(reader);
    const Vector3 vector = read_point(reader);
    frame.rotation.coeffs() << vector, reader.f32();  // x, y, z, w
    reader.skip(4);                                   // mean error of the markers
    frame.tracked = (reader.u16() & kTracked) != 0;
    frame.has_body = reader.ok();
  }
}

void skip_items(ByteReader& reader, std::size_t size) { reader.skip(reader.count_of(size) * size); }

/// Sections of a frame before 4.1, which are only as long as what they hold.
void read_plain_sections(ByteReader& reader, std::int32_t wanted, NatNetFrame& frame) {
  for (std::size_t sets = reader.count_of(1 + 4); sets > 0 && reader.ok(); --sets) {
    (void)reader.text();
    skip_items(reader, kPoint);
  }
  skip_items(reader, kPoint);  // unlabelled markers
  read_bodies(reader, reader.count_of(kRigidBody), wanted, frame);
  for (std::size_t skeletons = reader.count_of(4 + 4); skeletons > 0 && reader.ok(); --skeletons) {
    reader.skip(4);
    skip_items(reader, kRigidBody);
  }
  skip_items(reader, kLabelledMarker);
  for (int section = 0; section < 2; ++section) {  // force plates, devices
    for (std::size_t items = reader.count_of(4 + 4); items > 0 && reader.ok(); --items) {
      reader.skip(4);
      for (std::size_t channels = reader.count_of(4); channels > 0 && reader.ok(); --channels) {
        skip_items(reader, 4);
      }
    }
  }
}

/// Sections of a frame from 4.1: marker sets, unlabelled markers, rigid bodies, skeletons, assets,
/// labelled markers, force plates, devices.
void read_sized_sections(ByteReader& reader, std::int32_t wanted, NatNetFrame& frame) {
  constexpr int kSections = 8;
  constexpr int kRigidBodies = 2;
  for (int section = 0; section < kSections && reader.ok(); ++section) {
    const std::size_t count = reader.u32();
    ByteReader content(reader.bytes(reader.u32()));
    if (section != kRigidBodies) continue;
    if (count > content.left() / kRigidBody) return reader.fail();
    read_bodies(content, count, wanted, frame);
  }
}

/// Description of a rigid body, its name and id.
NatNetBody read_description(ByteReader& reader, NatNetVersion version) {
  NatNetBody body;
  body.name = reader.text();
  body.id = reader.i32();
  reader.skip(4 + kPoint);  // parent, offset
  if (version >= kBodyOrientation) reader.skip(16);
  const std::size_t markers = reader.count_of(kPoint + 4);
  reader.skip(markers * (kPoint + 4));
  if (version >= kNamedMarkers) {
    for (std::size_t i = 0; i < markers && reader.ok(); ++i) (void)reader.text();
  }
  return body;
}

void skip_texts(ByteReader& reader) {
  for (std::size_t count = reader.count_of(1); count > 0 && reader.ok(); --count) {
    (void)reader.text();
  }
}

/// Passes over a description before 4.1 that is no rigid body.
void skip_description(ByteReader& reader, std::uint32_t type, NatNetVersion version) {
  switch (type) {
    case 0:  // marker set
      (void)reader.text();
      return skip_texts(reader);
    case 2:  // skeleton
      (void)reader.text();
      reader.skip(4);
      for (std::size_t bones = reader.count_of(1); bones > 0 && reader.ok(); --bones) {
        (void)read_description(reader, version);
      }
      return;
    case 3:  // force plate: size, origin, calibration matrix, corners, types, channels
      reader.skip(4);
      (void)reader.text();
      reader.skip((2 + 3 + 12 * 12 + 4 * 3 + 2) * 4);
      return skip_texts(reader);
    case 4:  // device: name, serial number, types, channels
      reader.skip(4);
      (void)reader.text();
      (void)reader.text();
      reader.skip(2 * 4);
      return skip_texts(reader);
    case 5:  // camera: name, position, rotation
      (void)reader.text();
      return reader.skip(kPoint + 16);
    default:
      return reader.fail();
  }
}

}  // namespace

std::optional<NatNetFrame> decode_natnet_frame(std::span<const std::uint8_t> payload,
                                               NatNetVersion version, std::int32_t body) {
  ByteReader reader(payload);
  NatNetFrame frame;
  frame.number = reader.i32();
  if (version >= kSizedSections) {
    read_sized_sections(reader, body, frame);
  } else {
    read_plain_sections(reader, body, frame);
  }
  reader.skip(4 + 4 + 8);  // timecode, its fraction, time since the start of the software
  ByteReader stamps(reader.bytes(kStamps));
  frame.mid_exposure = stamps.u64();
  // Some servers put a time of the Precision Time Protocol before the flags.
  if (reader.left() >= 8 + 2 + 4) reader.skip(8);
  const std::uint16_t flags = reader.u16();
  reader.skip(4);  // end of data
  if (!reader.ok()) return std::nullopt;
  frame.models_changed = (flags & kModelsChanged) != 0;
  frame.version_changed = (flags & kVersionChanged) != 0;
  return frame;
}

std::optional<std::vector<NatNetBody>> decode_natnet_models(std::span<const std::uint8_t> payload,
                                                            NatNetVersion version) {
  constexpr std::uint32_t kRigidBodyType = 1;
  ByteReader reader(payload);
  const std::size_t count = reader.count_of(4);
  if (!reader.ok()) return std::nullopt;
  std::vector<NatNetBody> bodies;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t type = reader.u32();
    if (version >= kSizedSections) {
      ByteReader description(reader.bytes(reader.u32()));
      if (type != kRigidBodyType) continue;
      NatNetBody body = read_description(description, version);
      if (description.ok()) bodies.push_back(std::move(body));
    } else if (type == kRigidBodyType) {
      NatNetBody body = read_description(reader, version);
      if (reader.ok()) bodies.push_back(std::move(body));
    } else {
      skip_description(reader, type, version);
    }
    if (!reader.ok()) break;
  }
  return bodies;
}

}  // namespace softfinger
