#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "softfinger/motors/transport_settings.hpp"

namespace softfinger {

// Servos on a bus hold a control table: registers that are read and written by frames with the id
// of one servo, or of all. Dynamixel and Feetech servos differ in the frames and in the table.

enum class ServoInstruction : std::uint8_t {
  kPing = 0x01,
  kRead = 0x02,       ///< address, length -> status with the bytes
  kWrite = 0x03,      ///< address, bytes -> status
  kSyncRead = 0x82,   ///< address, length, ids -> one status each, in that order
  kSyncWrite = 0x83,  ///< address, length, (id, bytes)*; no answer
};

inline constexpr std::uint8_t kEveryServo = 0xFE;  ///< broadcast id

/// A frame without header, length and checksum.
struct ServoFrame {
  /// Enough for a sync write of four bytes to kMostServos servos.
  static constexpr std::size_t kMostParameters = 160;

  std::uint8_t id = 0;
  std::uint8_t code = 0;  ///< instruction, or what marks a status
  std::size_t size = 0;   ///< parameters used
  std::array<std::uint8_t, kMostParameters> parameters{};

  void add(std::uint8_t byte) { parameters[size++] = byte; }
  [[nodiscard]] std::span<const std::uint8_t> used() const {
    return std::span(parameters).first(size);
  }
};

/// What a servo answers.
struct ServoStatus {
  std::uint8_t id = 0;
  std::uint8_t error = 0;  ///< 0: none
  std::span<const std::uint8_t> data;
};

/// A register of a control table, low byte first.
struct ServoRegister {
  std::uint16_t address = 0;
  std::uint8_t size = 0;  ///< bytes, at most 4
};

/// Where a servo has what is needed here.
struct ControlTable {
  int address_bytes = 1;  ///< of addresses and lengths in frames
  ServoRegister torque, goal, present;
  ServoRegister temperature;  ///< degrees Celsius
  ServoRegister errors;       ///< see ServoProtocol::complaints()
  /// The error of a status is `errors`, and its data are good all the same.
  bool errors_in_status = false;
  /// Ends a servo's motion that hears nothing for so many kWatchdogUnit; kWatchdogBarked: it did,
  /// and takes no goal before 0 is written. Of size 0: there is none.
  ServoRegister watchdog;

  // What is read at once beside `present`, with what is meant in it. All differ in size: answers
  // may come late, and must not be taken for those to another question.
  ServoRegister torque_question;    ///< and `errors`, where a status does not tell them
  ServoRegister watchdog_question;  ///< of size 0: none
  ServoRegister temperature_question;
};

inline constexpr double kWatchdogUnit = 20e-3;  ///< s
inline constexpr std::uint32_t kMostWatchdog = 127;
inline constexpr std::uint32_t kWatchdogBarked = 0xFF;

/// Frames and control table of one family of servos. Pure functions.
class ServoProtocol {
 public:
  /// Longest frame of any family.
  static constexpr std::size_t kMostBytes = 240;

  virtual ~ServoProtocol() = default;
  [[nodiscard]] virtual const ControlTable& table() const = 0;
  /// Writes a whole frame to the front of `out` (kMostBytes or more); returns its length.
  virtual std::size_t encode(const ServoFrame& frame, std::span<std::uint8_t> out) const = 0;
  /// Length of the valid frame that `bytes` begin with; 0 where they may still become one; -1 where
  /// they cannot, or its checksum is wrong.
  [[nodiscard]] virtual int frame_length(std::span<const std::uint8_t> bytes) const = 0;
  /// The frame of bytes whose frame_length() is their number.
  [[nodiscard]] virtual ServoFrame decode(std::span<const std::uint8_t> bytes) const = 0;
  /// As an answer, into the frame's parameters; nothing where it is none.
  [[nodiscard]] virtual std::optional<ServoStatus> status(const ServoFrame& frame) const = 0;
  [[nodiscard]] virtual ServoFrame status_frame(std::uint8_t id, std::uint8_t error,
                                                std::span<const std::uint8_t> data) const = 0;
  /// Bits of ServoComplaint, from those of ControlTable::errors.
  [[nodiscard]] virtual std::uint8_t complaints(std::uint32_t errors) const = 0;
  /// A position in ticks as its register has it, and back.
  [[nodiscard]] virtual std::uint32_t to_register(std::int32_t position) const = 0;
  [[nodiscard]] virtual std::int32_t to_position(std::uint32_t value) const = 0;
};

// Requests of any family.
[[nodiscard]] ServoFrame ping_request(std::uint8_t id);
[[nodiscard]] ServoFrame read_request(const ServoProtocol& protocol, std::uint8_t id,
                                      ServoRegister from);
[[nodiscard]] ServoFrame write_request(const ServoProtocol& protocol, std::uint8_t id,
                                       ServoRegister to, std::uint32_t value);
/// At most kMostServos ids.
[[nodiscard]] ServoFrame sync_read_request(const ServoProtocol& protocol, ServoRegister from,
                                           std::span<const std::uint8_t> ids);
[[nodiscard]] ServoFrame sync_write_request(const ServoProtocol& protocol, ServoRegister to,
                                            std::span<const std::uint8_t> ids,
                                            std::span<const std::uint32_t> values);
/// A value of up to 4 bytes, low byte first.
[[nodiscard]] std::uint32_t register_value(std::span<const std::uint8_t> bytes);

}  // namespace softfinger
