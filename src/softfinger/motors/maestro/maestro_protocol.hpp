#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace softfinger {

// Compact serial protocol of the Pololu Maestro servo controllers ("Pololu Maestro Servo Controller
// User's Guide", sections 5.c to 5.f). A command byte has bit 7 set, its data bytes have it clear;
// 14-bit values go low 7 bits first. Targets are quarter microseconds of pulse width.

enum class MaestroCommand : std::uint8_t {
  kSetTarget = 0x84,        ///< channel, target (2); 0 stops the pulses
  kSetSpeed = 0x87,         ///< channel, speed (2) in 0.25 us / 10 ms; 0: no limit
  kSetAcceleration = 0x89,  ///< channel, acceleration (2) in 0.25 us / 10 ms / 80 ms; 0: no limit
  kGetPosition = 0x90,      ///< channel -> quarter microseconds, 2 bytes, low byte first
  kGetMovingState = 0x93,   ///< -> 1 byte, 0 when no servo moves
  kSetMultipleTargets = 0x9F,  ///< count, first channel, count targets (2 each); Mini Maestro only
  kGetErrors = 0xA1,           ///< -> 2 bytes, low byte first; reading clears them
  kGoHome = 0xA2,
};

/// Bits of the answer to kGetErrors.
enum MaestroError : std::uint16_t {
  kSerialSignalError = 1 << 0,
  kSerialOverrunError = 1 << 1,
  kSerialBufferFull = 1 << 2,
  kSerialCrcError = 1 << 3,
  kSerialProtocolError = 1 << 4,
  kSerialTimeout = 1 << 5,
};
/// The bits that tell of the line, not of a script on the board.
inline constexpr std::uint16_t kMaestroLineErrors = 0x3F;

inline constexpr int kMaestroChannels = 24;                ///< of the largest model
inline constexpr std::uint16_t kMaestroMaxValue = 0x3FFF;  ///< 14 bits
/// Unit of targets, s of pulse width.
inline constexpr double kQuarterMicrosecond = 0.25e-6;

/// 84 channel low7 high7. channel below kMaestroChannels, target at most kMaestroMaxValue.
[[nodiscard]] std::array<std::uint8_t, 4> encode_set_target(int channel, std::uint16_t target);
[[nodiscard]] std::array<std::uint8_t, 4> encode_set_speed(int channel, std::uint16_t speed);
[[nodiscard]] std::array<std::uint8_t, 4> encode_set_acceleration(int channel,
                                                                  std::uint16_t acceleration);
[[nodiscard]] std::array<std::uint8_t, 2> encode_get_position(int channel);
/// A command without data: kGetMovingState, kGetErrors, kGoHome.
[[nodiscard]] constexpr std::uint8_t encode(MaestroCommand command) {
  return static_cast<std::uint8_t>(command);
}

/// What follows a command where the board's CRC mode is on: CRC-7, polynomial 0x91, least bit
/// first (section 5.d). Answers have none.
[[nodiscard]] std::uint8_t maestro_crc(std::span<const std::uint8_t> command);

/// An answer of two bytes, low byte first.
[[nodiscard]] constexpr std::uint16_t decode_reply(std::uint8_t low, std::uint8_t high) {
  return static_cast<std::uint16_t>(low | (high << 8));
}

/// One decoded command.
struct MaestroRequest {
  MaestroCommand command{};
  int channel = 0;  ///< first channel of several
  int count = 0;    ///< values used
  std::array<std::uint16_t, kMaestroChannels> values{};
};

/// Reads a stream of command bytes one by one, as the controller does. Bytes that cannot be part of
/// a known command are counted and skipped; the next command byte starts afresh. Besides the
/// compact protocol it reads the Pololu protocol: AA, device number, command without bit 7, data.
class MaestroDecoder {
 public:
  /// `crc`: every command ends in its checksum.
  explicit MaestroDecoder(bool crc = false) : crc_(crc) {}
  /// The command that this byte completes, if it completes one.
  std::optional<MaestroRequest> push(std::uint8_t byte);
  /// Forgets half a command, as one that starts anew; the counts go on.
  void forget();
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] std::uint64_t malformed_bytes() const { return malformed_; }
  /// Whole commands that were refused since their checksum was wrong.
  [[nodiscard]] std::uint64_t crc_errors() const { return crc_errors_; }

 private:
  void discard();
  /// Its data are there: they are checked, or the checksum is still to come.
  std::optional<MaestroRequest> finish();
  std::optional<MaestroRequest> complete();
  /// Data bytes that follow the command byte, as far as they are known; -1: no such command.
  [[nodiscard]] int data_length() const;

  bool crc_;
  std::uint8_t sum_ = 0;  ///< of the command under way, so far
  bool sum_due_ = false;  ///< nothing but its checksum is missing
  std::array<std::uint8_t, 2 + 2 * kMaestroChannels> data_{};
  int received_ = 0;          ///< data bytes of the command under way
  int header_ = 0;            ///< bytes before them: the command byte, or AA, device and command
  std::uint8_t command_ = 0;  ///< 0: none under way
  int pololu_ = 0;  ///< of AA device command: bytes of it seen while the command is not yet known
  std::uint64_t bytes_ = 0;
  std::uint64_t malformed_ = 0;
  std::uint64_t crc_errors_ = 0;
};

}  // namespace softfinger
