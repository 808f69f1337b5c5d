#include "softfinger/motors/feetech/feetech_protocol.hpp"

#include <cassert>
#include <cstdlib>

#include "softfinger/motors/servo_faults.hpp"

namespace softfinger {
namespace {

constexpr std::size_t kInstructionAt = 4;
constexpr std::uint32_t kSign = 0x8000;

std::uint8_t checksum(std::span<const std::uint8_t> bytes) {
  unsigned sum = 0;
  for (const std::uint8_t byte : bytes) sum += byte;
  return static_cast<std::uint8_t>(~sum & 0xFFU);
}

}  // namespace

const ControlTable& FeetechProtocol::table() const {
  static constexpr ControlTable kTable{.address_bytes = 1,
                                       .torque = {0x28, 1},
                                       .goal = {0x2A, 2},
                                       .present = {0x38, 2},
                                       .temperature = {0x3F, 1},
                                       .errors = {0x41, 1},
                                       .errors_in_status = true,
                                       .watchdog = {},
                                       .torque_question = {0x28, 1},
                                       .watchdog_question = {},
                                       .temperature_question = {0x3E, 3}};
  return kTable;
}

std::uint8_t FeetechProtocol::complaints(std::uint32_t errors) const {
  constexpr std::uint32_t kVoltage = 1U << 0, kSensor = 1U << 1, kHeat = 1U << 2,
                          kCurrent = 1U << 3, kLoad = 1U << 5;
  std::uint8_t found = 0;
  if ((errors & kVoltage) != 0) found |= kBadVoltage;
  if ((errors & kHeat) != 0) found |= kTooHot;
  if ((errors & (kCurrent | kLoad)) != 0) found |= kOverload;
  if ((errors & kSensor) != 0) found |= kDefect;
  return found;
}

std::size_t FeetechProtocol::encode(const ServoFrame& frame, std::span<std::uint8_t> out) const {
  assert(out.size() >= kMostBytes);
  std::size_t size = 0;
  out[size++] = 0xFF;
  out[size++] = 0xFF;
  out[size++] = frame.id;
  out[size++] = static_cast<std::uint8_t>(frame.size + 2);
  out[size++] = frame.code;
  for (const std::uint8_t byte : frame.used()) out[size++] = byte;
  out[size] = checksum(out.subspan(2, size - 2));
  return size + 1;
}

int FeetechProtocol::frame_length(std::span<const std::uint8_t> bytes) const {
  for (std::size_t i = 0; i < 2 && i < bytes.size(); ++i) {
    if (bytes[i] != 0xFF) return -1;
  }
  // No servo has the id FF: a third one makes the first noise.
  if (bytes.size() > 2 && bytes[2] == 0xFF) return -1;
  if (bytes.size() < kInstructionAt) return 0;
  const std::size_t length = bytes[3];
  if (length < 2 || length - 2 > ServoFrame::kMostParameters) return -1;
  const std::size_t size = kInstructionAt + length;
  if (bytes.size() < size) return 0;
  return checksum(bytes.subspan(2, size - 3)) == bytes[size - 1] ? static_cast<int>(size) : -1;
}

ServoFrame FeetechProtocol::decode(std::span<const std::uint8_t> bytes) const {
  ServoFrame frame;
  frame.id = bytes[2];
  frame.code = bytes[kInstructionAt];
  for (std::size_t i = kInstructionAt + 1; i + 1 < bytes.size(); ++i) frame.add(bytes[i]);
  return frame;
}

std::optional<ServoStatus> FeetechProtocol::status(const ServoFrame& frame) const {
  if (frame.id == kEveryServo) return std::nullopt;
  return ServoStatus{.id = frame.id, .error = frame.code, .data = frame.used()};
}

ServoFrame FeetechProtocol::status_frame(std::uint8_t id, std::uint8_t error,
                                         std::span<const std::uint8_t> data) const {
  ServoFrame frame;
  frame.id = id;
  frame.code = error;
  for (const std::uint8_t byte : data) frame.add(byte);
  return frame;
}

std::uint32_t FeetechProtocol::to_register(std::int32_t position) const {
  const auto size = static_cast<std::uint32_t>(std::abs(position));
  return (size & (kSign - 1)) | (position < 0 ? kSign : 0U);
}

std::int32_t FeetechProtocol::to_position(std::uint32_t value) const {
  const auto size = static_cast<std::int32_t>(value & (kSign - 1));
  return (value & kSign) != 0 ? -size : size;
}

}  // namespace softfinger
