#include "softfinger/motors/maestro/maestro_bus.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/motors/maestro/maestro_protocol.hpp"

namespace softfinger {
namespace {

/// Of the pulse width, s per s and s per s^2 ("User's Guide", sections 5.e: speed and
/// acceleration).
constexpr double kSpeedUnit = kQuarterMicrosecond / 10e-3;
constexpr double kAccelerationUnit = kQuarterMicrosecond / (10e-3 * 80e-3);

/// Bytes of a channel in a tick: its target, the question for its position, and the answer.
constexpr double kBytesOfChannel = 4.0 + 2.0 + 2.0;

/// A line that carries less than is sent would carry out the past.
void check_speed(const TransportSettings& transport) {
  const double time = SerialPort::kBitsPerByte * kBytesOfChannel *
                      static_cast<double>(transport.servos.size()) / transport.baud;
  if (time * transport.rate <= 1.0) return;
  throw InputError(fmt::format(
      "transport.rate_Hz: {:g} ticks a second leave {:.3g} ms each, but {} servos at {} baud need "
      "{:.3g} ms; lower rate_Hz, or set board and file to more baud (over USB the file alone)",
      transport.rate, 1e3 / transport.rate, transport.servos.size(), transport.baud, 1e3 * time));
}

/// Not below what is wanted; 0 would be no limit.
std::uint16_t maestro_limit(double units, std::uint16_t most) {
  return static_cast<std::uint16_t>(std::clamp(std::ceil(units), 1.0, static_cast<double>(most)));
}

}  // namespace

MaestroBus::MaestroBus(const TransportSettings& transport)
    : baud_(static_cast<unsigned>(transport.baud)) {
  for (const ServoSettings& servo : transport.servos) {
    if (servo.channel < 0 || servo.channel >= kMaestroChannels) {
      throw InputError(fmt::format("transport.servo.channel: {} is none of a Maestro's 0 to {}",
                                   servo.channel, kMaestroChannels - 1));
    }
    channels_.push_back(servo.channel);
    const auto add = [&](std::span<const std::uint8_t> bytes) {
      limits_.insert(limits_.end(), bytes.begin(), bytes.end());
    };
    if (servo.max_rate <= 0.0) continue;
    add(encode_set_speed(servo.channel,
                         maestro_limit(servo.max_rate / kSpeedUnit, kMaestroMaxValue)));
    add(encode_set_acceleration(servo.channel,
                                servo.max_acceleration > 0.0
                                    ? maestro_limit(servo.max_acceleration / kAccelerationUnit, 255)
                                    : std::uint16_t{0}));
  }
  check_speed(transport);
}

std::string MaestroBus::open(const std::string& port) {
  std::string reason = port_.open(port, baud_);
  port_.discard_input();
  answers_ = false;
  pulses_ = false;
  limits_due_ = false;
  if (reason.empty() && !limits_.empty() && port_.write(limits_) != SerialPort::Result::kSent) {
    port_.close();
    return "it does not take what limits the servos' speed";
  }
  return reason;
}

bool MaestroBus::write(std::span<const std::int32_t> targets) noexcept {
  if (limits_due_ && port_.write(limits_) == SerialPort::Result::kSent) limits_due_ = false;
  std::array<std::uint8_t, 4 * kMaestroChannels> bytes;
  std::size_t size = 0;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const auto target = static_cast<std::uint16_t>(targets[i]);
    for (const std::uint8_t byte : encode_set_target(channels_[i], target)) bytes[size++] = byte;
  }
  return port_.write(std::span(bytes).first(size)) == SerialPort::Result::kSent;
}

bool MaestroBus::let_go() noexcept {
  // A target of 0 stops the pulses, and a hobby servo without pulses has no torque.
  constexpr std::array<std::int32_t, kMaestroChannels> kNoPulses{};
  return write(std::span(kNoPulses).first(channels_.size()));
}

bool MaestroBus::ask() noexcept {
  std::array<std::uint8_t, 2 * kMaestroChannels> question;
  std::size_t size = 0;
  for (const int channel : channels_) {
    for (const std::uint8_t byte : encode_get_position(channel)) question[size++] = byte;
  }
  port_.write(std::span(question).first(size));
  return true;
}

bool MaestroBus::take_positions(std::span<std::int32_t> positions) noexcept {
  std::array<std::uint8_t, 16 * 2 * kMaestroChannels> answer;
  // Several whole answers came late, and the last one counts; anything else is noise of the line.
  const std::size_t size = 2 * channels_.size();
  const std::size_t got = port_.read(answer);
  if (got == 0 || got % size != 0) return false;
  answers_ = true;
  const auto last = std::span(answer).subspan(got - size, size);
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    positions[i] = decode_reply(last[2 * i], last[2 * i + 1]);
    if (positions[i] != 0) continue;
    // No pulses: the servo may be anywhere.
    limits_due_ = limits_due_ || pulses_;
    pulses_ = false;
    return false;
  }
  pulses_ = true;
  return true;
}

}  // namespace softfinger
