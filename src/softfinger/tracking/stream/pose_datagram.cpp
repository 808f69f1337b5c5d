#include "softfinger/tracking/stream/pose_datagram.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/wire/byte_order.hpp"

namespace softfinger {
namespace {

constexpr std::uint32_t kMagic = 0x4f504653;  // "SFPO"
constexpr std::uint32_t kVersion = 1;
constexpr double kLatestTime = 1e12;  // s: beyond, steps of a clock are no longer told apart

}  // namespace

std::optional<PoseMessage> decode_pose_datagram(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != kPoseDatagramSize) return std::nullopt;
  ByteReader reader(bytes);
  if (reader.u32() != kMagic || reader.u32() != kVersion) return std::nullopt;
  PoseMessage message;
  message.sequence = reader.u32();
  const std::uint32_t tracked = reader.u32();
  message.time = reader.f64();
  if (tracked > 1 || !(std::abs(*message.time) <= kLatestTime)) return std::nullopt;
  message.valid = tracked == 1;
  if (!message.valid) return message;
  std::array<double, 7> v{};
  for (double& number : v) number = reader.f64();
  const auto pose = pose_from_outside({v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]});
  if (!pose) return std::nullopt;
  message.X_WFt = *pose;
  return message;
}

PoseDatagram encode_pose_datagram(const PoseMessage& message) {
  ByteWriter writer;
  writer.u32(kMagic);
  writer.u32(kVersion);
  writer.u32(message.sequence.value_or(0));
  writer.u32(message.valid ? 1 : 0);
  writer.f64(message.time.value_or(0.0));
  const Eigen::Quaterniond q(message.X_WFt.rotation);
  const Vector3& p = message.X_WFt.translation;
  for (const double number : {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()}) writer.f64(number);
  PoseDatagram datagram{};
  std::copy(writer.bytes().begin(), writer.bytes().end(), datagram.begin());
  return datagram;
}

}  // namespace softfinger
