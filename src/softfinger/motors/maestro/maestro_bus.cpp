#include "softfinger/motors/maestro/maestro_bus.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "softfinger/base/error.hpp"
#include "softfinger/motors/maestro/maestro_protocol.hpp"

namespace softfinger {
namespace {

/// Of the pulse width, s per s and s per s^2 ("User's Guide", sections 5.e: speed and
/// acceleration).
constexpr double kSpeedUnit = kQuarterMicrosecond / 10e-3;
constexpr double kAccelerationUnit = kQuarterMicrosecond / (10e-3 * 80e-3);

/// For an answer while the port is opened.
constexpr std::chrono::milliseconds kAnswerTime{50};
/// A board's timeout is counted in hundredths of a second, by a clock of its own.
constexpr double kTimeoutReserve = 1.1;
constexpr std::chrono::milliseconds kTimeoutStep{20};
/// A busy machine is no slow line.
constexpr int kPaceTries = 5;
constexpr std::size_t kPaceQuestions = 5;
/// Answers without an error in a row that end a complaint.
constexpr int kSuspicion = 8;
/// An answer to a question for the errors, or for the position of a channel.
constexpr std::size_t kAnswerBytes = 2;

/// Bytes of a channel in a tick: its target, the question for its position, and the answer.
std::size_t bytes_of_tick(const TransportSettings& transport) {
  const std::size_t sums = transport.crc ? 1 : 0;
  const std::size_t of_channel = 4 + sums + 2 + sums + kAnswerBytes;
  return transport.servos.size() * of_channel + 1 + sums + kAnswerBytes;
}

/// A line that carries less than is sent would carry out the past.
void check_speed(const TransportSettings& transport) {
  const double time =
      SerialPort::kBitsPerByte * static_cast<double>(bytes_of_tick(transport)) / transport.baud;
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

MaestroBus::MaestroBus(const TransportSettings& transport, LineClock& clock)
    : clock_(clock),
      baud_(static_cast<unsigned>(transport.baud)),
      period_(1.0 / transport.rate),
      crc_(transport.crc),
      serial_timeout_(transport.serial_timeout) {
  for (const ServoSettings& servo : transport.servos) {
    if (servo.channel < 0 || servo.channel >= kMaestroChannels) {
      throw InputError(fmt::format("transport.servo.channel: {} is none of a Maestro's 0 to {}",
                                   servo.channel, kMaestroChannels - 1));
    }
    channels_.push_back(servo.channel);
    add(question_, encode_get_position(servo.channel));
    if (servo.max_rate <= 0.0) continue;
    add(limits_, encode_set_speed(servo.channel,
                                  maestro_limit(servo.max_rate / kSpeedUnit, kMaestroMaxValue)));
    add(limits_,
        encode_set_acceleration(servo.channel,
                                servo.max_acceleration > 0.0
                                    ? maestro_limit(servo.max_acceleration / kAccelerationUnit, 255)
                                    : std::uint16_t{0}));
  }
  add(error_question_, std::array{encode(MaestroCommand::kGetErrors)});
  question_.insert(question_.end(), error_question_.begin(), error_question_.end());
  check_speed(transport);
  tick_share_ = static_cast<double>(bytes_of_tick(transport)) /
                static_cast<double>(question_.size() + answer_size());
}

void MaestroBus::add(std::vector<std::uint8_t>& bytes,
                     std::span<const std::uint8_t> command) const {
  bytes.insert(bytes.end(), command.begin(), command.end());
  if (crc_) bytes.push_back(maestro_crc(command));
}

std::vector<std::uint8_t> MaestroBus::exchange(std::span<const std::uint8_t> question,
                                               std::size_t size, LineClock::Duration patience) {
  port_.discard_input();
  port_.write(question);
  std::vector<std::uint8_t> answer(size);
  std::size_t got = 0;
  const LineClock::TimePoint until = clock_.now() + patience;
  while (got < size && port_.is_open() && clock_.now() < until) {
    port_.await_kernel();
    const std::size_t more = port_.read(std::span(answer).subspan(got));
    got += more;
    if (more == 0) clock_.sleep_for(std::chrono::microseconds(300));
  }
  if (got < size) answer.clear();
  return answer;
}

std::optional<std::uint16_t> MaestroBus::errors() {
  const std::vector<std::uint8_t> answer = exchange(error_question_, kAnswerBytes, kAnswerTime);
  if (answer.empty()) return std::nullopt;
  return decode_reply(answer[0], answer[1]);
}

std::string MaestroBus::check_crc() {
  // A board without checksums takes this one for a command that is none.
  const std::optional<std::uint16_t> noted = errors();
  if (!noted) {
    return "it answers no question with a checksum; is its CRC mode on, and its own line wired?";
  }
  if ((*noted & kSerialProtocolError) == 0) return {};
  return "its CRC mode is off: put it on in Pololu's Maestro Control Center, or leave out crc";
}

std::string MaestroBus::check_timeout() {
  const auto silence = std::chrono::duration<double>(kTimeoutReserve * serial_timeout_);
  clock_.sleep_for(std::chrono::ceil<std::chrono::milliseconds>(silence) + kTimeoutStep);
  const std::optional<std::uint16_t> noted = errors();
  if (!noted) return "it does not answer whether its serial timeout is on; is its own line wired?";
  if ((*noted & kSerialTimeout) != 0) return {};
  return fmt::format(
      "its serial timeout is off, or longer than {:g} ms: set it in Pololu's Maestro Control "
      "Center, or leave out serial_timeout_ms",
      1e3 * serial_timeout_);
}

LineClock::Duration MaestroBus::time_of(std::size_t questions, LineClock::Duration patience) {
  std::vector<std::uint8_t> all;
  for (std::size_t i = 0; i < questions; ++i) {
    all.insert(all.end(), question_.begin(), question_.end());
  }
  LineClock::Duration least = patience;
  for (int i = 0; i < kPaceTries; ++i) {
    const LineClock::TimePoint asked = clock_.now();
    if (exchange(all, questions * answer_size(), patience).empty()) continue;
    least = std::min(least, clock_.now() - asked);
  }
  return least;
}

std::string MaestroBus::check_pace() {
  const auto patience = std::chrono::duration_cast<LineClock::Duration>(
      kAnswerTime + std::chrono::duration<double>(kPaceQuestions * period_));
  const auto more = time_of(kPaceQuestions, patience) - time_of(1, patience);
  const double tick =
      tick_share_ * std::chrono::duration<double>(more).count() / (kPaceQuestions - 1);
  if (tick < period_) return {};
  return fmt::format("its line takes {:.3g} ms for what a tick of {:.3g} ms says; lower rate_Hz",
                     1e3 * tick, 1e3 * period_);
}

std::string MaestroBus::open(const std::string& port) {
  std::string reason = port_.open(port, baud_);
  answers_ = false;
  pulses_ = false;
  limits_due_ = false;
  complaints_ = 0;
  suspicion_ = 0;
  if (!reason.empty()) return reason;
  const bool heard = errors().has_value();  // and so forgotten: they are of the past
  if (!under_way_ && crc_) reason = check_crc();
  if (reason.empty() && !limits_.empty() && port_.write(limits_) != SerialPort::Result::kSent) {
    reason = "it does not take what limits the servos' speed";
  }
  if (!under_way_) {
    // A board whose timeout is on takes its servos home now, and no faster than that.
    if (reason.empty() && serial_timeout_ > 0.0) reason = check_timeout();
    if (reason.empty() && heard) reason = check_pace();
  }
  if (!reason.empty()) port_.close();
  return reason;
}

bool MaestroBus::write(std::span<const std::int32_t> targets) noexcept {
  if (limits_due_ && port_.write(limits_) == SerialPort::Result::kSent) limits_due_ = false;
  std::array<std::uint8_t, 5 * kMaestroChannels> bytes;
  std::size_t size = 0;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const auto command = encode_set_target(channels_[i], static_cast<std::uint16_t>(targets[i]));
    for (const std::uint8_t byte : command) bytes[size++] = byte;
    if (crc_) bytes[size++] = maestro_crc(command);
  }
  return port_.write(std::span(bytes).first(size)) == SerialPort::Result::kSent;
}

bool MaestroBus::let_go() noexcept {
  // A target of 0 stops the pulses, and a hobby servo without pulses has no torque.
  constexpr std::array<std::int32_t, kMaestroChannels> kNoPulses{};
  return write(std::span(kNoPulses).first(channels_.size()));
}

bool MaestroBus::ask() noexcept {
  port_.write(question_);
  return true;
}

void MaestroBus::drain() noexcept {
  // Before anything is to be sent, so that the board's own patience does not end.
  if (serial_timeout_ > 0.0 && port_.is_open()) port_.write(error_question_);
  port_.drain();
}

void MaestroBus::note(std::uint16_t errors) noexcept {
  // Half a command is left of a board that was reset, once; a line that spoils does it again.
  const bool again = suspicion_ > 0;
  if (errors != 0) {
    suspicion_ = kSuspicion;
  } else if (suspicion_ > 0 && --suspicion_ == 0) {
    complaints_ = 0;
  }
  const std::uint16_t spoilt = kMaestroLineErrors & ~kSerialTimeout;
  if (((errors & spoilt) != 0 && again) || (errors & kSerialTimeout) != 0) complaints_ |= kBadLine;
  if ((errors & ~kMaestroLineErrors) != 0) complaints_ |= kDefect;
}

bool MaestroBus::take_positions(std::span<std::int32_t> positions) noexcept {
  std::array<std::uint8_t, 16 * kAnswerBytes*(kMaestroChannels + 1)> answer;
  // Several whole answers came late, and the last one counts; anything else is noise of the line.
  const std::size_t size = answer_size();
  const std::size_t got = port_.read(answer);
  if (got == 0 || got % size != 0) return false;
  answers_ = true;
  std::uint16_t errors = 0;
  for (std::size_t end = size; end <= got; end += size) {
    errors |= decode_reply(answer[end - 2], answer[end - 1]);
  }
  note(errors);
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
