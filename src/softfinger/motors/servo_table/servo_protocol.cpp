#include "softfinger/motors/servo_table/servo_protocol.hpp"

#include <cassert>

namespace softfinger {
namespace {

ServoFrame request(std::uint8_t id, ServoInstruction instruction) {
  ServoFrame frame;
  frame.id = id;
  frame.code = static_cast<std::uint8_t>(instruction);
  return frame;
}

void add_number(ServoFrame& frame, std::uint32_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) frame.add(static_cast<std::uint8_t>((value >> (8 * i)) & 0xFF));
}

void add_register(ServoFrame& frame, const ServoProtocol& protocol, ServoRegister at,
                  bool with_length) {
  const int bytes = protocol.table().address_bytes;
  add_number(frame, at.address, bytes);
  if (with_length) add_number(frame, at.size, bytes);
}

}  // namespace

ServoFrame ping_request(std::uint8_t id) { return request(id, ServoInstruction::kPing); }

ServoFrame read_request(const ServoProtocol& protocol, std::uint8_t id, ServoRegister from) {
  ServoFrame frame = request(id, ServoInstruction::kRead);
  add_register(frame, protocol, from, true);
  return frame;
}

ServoFrame write_request(const ServoProtocol& protocol, std::uint8_t id, ServoRegister to,
                         std::uint32_t value) {
  ServoFrame frame = request(id, ServoInstruction::kWrite);
  add_register(frame, protocol, to, false);
  add_number(frame, value, to.size);
  return frame;
}

ServoFrame sync_read_request(const ServoProtocol& protocol, ServoRegister from,
                             std::span<const std::uint8_t> ids) {
  assert(ids.size() <= static_cast<std::size_t>(kMostServos));
  ServoFrame frame = request(kEveryServo, ServoInstruction::kSyncRead);
  add_register(frame, protocol, from, true);
  for (const std::uint8_t id : ids) frame.add(id);
  return frame;
}

ServoFrame sync_write_request(const ServoProtocol& protocol, ServoRegister to,
                              std::span<const std::uint8_t> ids,
                              std::span<const std::uint32_t> values) {
  assert(ids.size() <= static_cast<std::size_t>(kMostServos) && ids.size() == values.size());
  ServoFrame frame = request(kEveryServo, ServoInstruction::kSyncWrite);
  add_register(frame, protocol, to, true);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    frame.add(ids[i]);
    add_number(frame, values[i], to.size);
  }
  return frame;
}

std::uint32_t register_value(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes.size() && i < 4; ++i) {
    value |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  }
  return value;
}

}  // namespace softfinger
