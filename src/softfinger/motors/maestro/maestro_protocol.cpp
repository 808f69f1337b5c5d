#include "softfinger/motors/maestro/maestro_protocol.hpp"

#include <cassert>
#include <cstddef>

namespace softfinger {
namespace {

constexpr std::uint8_t kPololuStart = 0xAA;
constexpr std::uint8_t kCrcPolynomial = 0x91;

constexpr std::uint8_t low7(std::uint16_t value) { return static_cast<std::uint8_t>(value & 0x7F); }
constexpr std::uint8_t high7(std::uint16_t value) {
  return static_cast<std::uint8_t>((value >> 7) & 0x7F);
}

std::array<std::uint8_t, 4> encode_value(MaestroCommand command, int channel, std::uint16_t value) {
  assert(channel >= 0 && channel < kMaestroChannels && value <= kMaestroMaxValue);
  return {encode(command), static_cast<std::uint8_t>(channel), low7(value), high7(value)};
}

/// The checksum goes on over another byte.
constexpr std::uint8_t crc_after(std::uint8_t crc, std::uint8_t byte) {
  crc ^= byte;
  for (int bit = 0; bit < 8; ++bit) {
    if ((crc & 1) != 0) crc ^= kCrcPolynomial;
    crc = static_cast<std::uint8_t>(crc >> 1);
  }
  return crc;
}

}  // namespace

std::uint8_t maestro_crc(std::span<const std::uint8_t> command) {
  std::uint8_t crc = 0;
  for (const std::uint8_t byte : command) crc = crc_after(crc, byte);
  return crc;
}

std::array<std::uint8_t, 4> encode_set_target(int channel, std::uint16_t target) {
  return encode_value(MaestroCommand::kSetTarget, channel, target);
}

std::array<std::uint8_t, 4> encode_set_speed(int channel, std::uint16_t speed) {
  return encode_value(MaestroCommand::kSetSpeed, channel, speed);
}

std::array<std::uint8_t, 4> encode_set_acceleration(int channel, std::uint16_t acceleration) {
  return encode_value(MaestroCommand::kSetAcceleration, channel, acceleration);
}

std::array<std::uint8_t, 2> encode_get_position(int channel) {
  return {encode(MaestroCommand::kGetPosition), static_cast<std::uint8_t>(channel)};
}

int MaestroDecoder::data_length() const {
  switch (static_cast<MaestroCommand>(command_)) {
    case MaestroCommand::kSetTarget:
    case MaestroCommand::kSetSpeed:
    case MaestroCommand::kSetAcceleration:
      return 3;
    case MaestroCommand::kGetPosition:
      return 1;
    case MaestroCommand::kSetMultipleTargets:
      return 2 + 2 * data_[0];  // some, before their number has come
    case MaestroCommand::kGetMovingState:
    case MaestroCommand::kGetErrors:
    case MaestroCommand::kGoHome:
      return 0;
  }
  return -1;
}

void MaestroDecoder::discard() {
  malformed_ += static_cast<std::uint64_t>(header_ + received_);
  forget();
}

void MaestroDecoder::forget() {
  command_ = 0;
  pololu_ = 0;
  header_ = 0;
  received_ = 0;
  sum_ = 0;
  sum_due_ = false;
}

std::optional<MaestroRequest> MaestroDecoder::finish() {
  if (!crc_) return complete();
  sum_due_ = true;
  return std::nullopt;
}

std::optional<MaestroRequest> MaestroDecoder::complete() {
  MaestroRequest request;
  request.command = static_cast<MaestroCommand>(command_);
  const auto value = [this](std::size_t at) {
    return static_cast<std::uint16_t>(data_[at] | (data_[at + 1] << 7));
  };
  if (request.command == MaestroCommand::kSetMultipleTargets) {
    request.channel = data_[1];
    request.count = data_[0];
    for (std::size_t i = 0; i < data_[0]; ++i) request.values[i] = value(2 + 2 * i);
  } else if (received_ > 0) {
    request.channel = data_[0];
    if (received_ == 3) {
      request.count = 1;
      request.values[0] = value(1);
    }
  }
  const int channels = request.command == MaestroCommand::kSetMultipleTargets ? request.count : 1;
  if (request.channel + channels > kMaestroChannels) {
    discard();
    return std::nullopt;
  }
  forget();
  return request;
}

std::optional<MaestroRequest> MaestroDecoder::push(std::uint8_t byte) {
  ++bytes_;
  if ((byte & 0x80) != 0) {
    discard();  // a command byte in the middle of a command: what came before is lost
    header_ = 1;
    sum_ = crc_after(0, byte);
    if (byte == kPololuStart) {
      pololu_ = 1;
      return std::nullopt;
    }
    command_ = byte;
  } else if (sum_due_) {
    if (byte == sum_) return complete();
    ++crc_errors_;
    forget();
    return std::nullopt;
  } else if (pololu_ == 1) {
    sum_ = crc_after(sum_, byte);
    pololu_ = 2;  // device number: this controller answers to any
    header_ = 2;
    return std::nullopt;
  } else if (pololu_ == 2) {
    pololu_ = 0;
    header_ = 3;
    sum_ = crc_after(sum_, byte);
    command_ = static_cast<std::uint8_t>(byte | 0x80);
  } else if (command_ == 0) {
    ++malformed_;
    return std::nullopt;
  } else {
    data_[static_cast<std::size_t>(received_)] = byte;
    ++received_;
    sum_ = crc_after(sum_, byte);
    if (static_cast<MaestroCommand>(command_) == MaestroCommand::kSetMultipleTargets &&
        received_ == 1 && (byte == 0 || byte > kMaestroChannels)) {
      discard();
      return std::nullopt;
    }
  }
  const int length = data_length();
  if (length < 0) {
    discard();
    return std::nullopt;
  }
  return received_ < length ? std::nullopt : finish();
}

}  // namespace softfinger
