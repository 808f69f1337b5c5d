#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"

#include <algorithm>
#include <cassert>

#include "softfinger/motors/servo_faults.hpp"

namespace softfinger {
namespace {

constexpr std::array<std::uint8_t, 4> kHeader{0xFF, 0xFF, 0xFD, 0x00};
constexpr std::size_t kBody = 7;  ///< where the instruction stands
constexpr std::uint8_t kStatus = 0x55;
constexpr std::uint8_t kAlert = 0x80;

constexpr std::uint8_t low(std::size_t value) { return static_cast<std::uint8_t>(value & 0xFF); }
constexpr std::uint8_t high(std::size_t value) {
  return static_cast<std::uint8_t>((value >> 8) & 0xFF);
}

bool ends_like_a_header(std::span<const std::uint8_t> bytes) {
  const std::size_t n = bytes.size();
  return n >= 3 && bytes[n - 3] == 0xFF && bytes[n - 2] == 0xFF && bytes[n - 1] == 0xFD;
}

}  // namespace

std::uint16_t dynamixel_crc(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<std::uint32_t>(byte) << 8;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? ((crc << 1) ^ 0x8005U) & 0xFFFFU : (crc << 1) & 0xFFFFU;
    }
  }
  return static_cast<std::uint16_t>(crc);
}

const ControlTable& DynamixelProtocol::table() const {
  static constexpr ControlTable kTable{.address_bytes = 2,
                                       .torque = {64, 1},
                                       .goal = {116, 4},
                                       .present = {132, 4},
                                       .temperature = {146, 1},
                                       .errors = {70, 1},
                                       .watchdog = {98, 1},
                                       .torque_question = {64, 7},
                                       .watchdog_question = {98, 2},
                                       .temperature_question = {144, 3}};
  return kTable;
}

std::uint8_t DynamixelProtocol::complaints(std::uint32_t errors) const {
  constexpr std::uint32_t kVoltage = 1U << 0, kHeat = 1U << 2, kEncoder = 1U << 3, kShock = 1U << 4,
                          kLoad = 1U << 5;
  std::uint8_t found = 0;
  if ((errors & kVoltage) != 0) found |= kBadVoltage;
  if ((errors & kHeat) != 0) found |= kTooHot;
  if ((errors & kLoad) != 0) found |= kOverload;
  if ((errors & (kEncoder | kShock)) != 0) found |= kDefect;
  return found;
}

std::size_t DynamixelProtocol::encode(const ServoFrame& frame, std::span<std::uint8_t> out) const {
  assert(out.size() >= kMostBytes);
  std::copy(kHeader.begin(), kHeader.end(), out.begin());
  out[4] = frame.id;
  std::size_t size = kBody;
  out[size++] = frame.code;
  for (const std::uint8_t byte : frame.used()) {
    out[size++] = byte;
    if (ends_like_a_header(out.subspan(kBody, size - kBody))) out[size++] = 0xFD;
  }
  const std::size_t length = size - kBody + 2;
  out[5] = low(length);
  out[6] = high(length);
  const std::uint16_t crc = dynamixel_crc(out.first(size));
  out[size++] = low(crc);
  out[size++] = high(crc);
  return size;
}

int DynamixelProtocol::frame_length(std::span<const std::uint8_t> bytes) const {
  for (std::size_t i = 0; i < kHeader.size() && i < bytes.size(); ++i) {
    if (bytes[i] != kHeader[i]) return -1;
  }
  if (bytes.size() < kBody) return 0;
  const std::size_t length = bytes[5] | static_cast<std::size_t>(bytes[6]) << 8;
  if (length < 3 || kBody + length > kMostBytes) return -1;
  if (bytes.size() < kBody + length) return 0;
  const std::size_t end = kBody + length - 2;
  const std::uint16_t crc = dynamixel_crc(bytes.first(end));
  if (bytes[end] != low(crc) || bytes[end + 1] != high(crc)) return -1;
  // Every header inside must have been stuffed, and what is left must fit.
  std::size_t parameters = 0;
  for (std::size_t i = kBody + 1; i < end; ++i) {
    ++parameters;
    if (!ends_like_a_header(bytes.subspan(kBody, i + 1 - kBody))) continue;
    if (i + 1 >= end || bytes[i + 1] != 0xFD) return -1;
    ++i;
  }
  if (parameters > ServoFrame::kMostParameters) return -1;
  return static_cast<int>(kBody + length);
}

ServoFrame DynamixelProtocol::decode(std::span<const std::uint8_t> bytes) const {
  ServoFrame frame;
  frame.id = bytes[4];
  frame.code = bytes[kBody];
  const std::size_t end = bytes.size() - 2;
  for (std::size_t i = kBody + 1; i < end; ++i) {
    frame.add(bytes[i]);
    if (ends_like_a_header(bytes.subspan(kBody, i + 1 - kBody))) ++i;
  }
  return frame;
}

std::optional<ServoStatus> DynamixelProtocol::status(const ServoFrame& frame) const {
  if (frame.code != kStatus || frame.size < 1) return std::nullopt;
  return ServoStatus{.id = frame.id,
                     .error = static_cast<std::uint8_t>(frame.parameters[0] & ~kAlert),
                     .data = frame.used().subspan(1)};
}

ServoFrame DynamixelProtocol::status_frame(std::uint8_t id, std::uint8_t error,
                                           std::span<const std::uint8_t> data) const {
  ServoFrame frame;
  frame.id = id;
  frame.code = kStatus;
  frame.add(error);
  for (const std::uint8_t byte : data) frame.add(byte);
  return frame;
}

}  // namespace softfinger
