#include "softfinger/motors/maestro/maestro_emulator.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {

MaestroBoard maestro_board(const TransportSettings& transport) {
  MaestroBoard board{.crc = transport.crc, .serial_timeout = transport.serial_timeout};
  if (transport.serial_timeout > 0.0) board.on_error = MaestroBoard::OnError::kGoTo;
  return board;
}

MaestroEmulator::MaestroEmulator(std::span<const EmulatedServo> servos, const MaestroBoard& board)
    : board_(board), decoder_(board.crc) {
  for (const EmulatedServo& servo : servos) {
    Channel& channel = channels_.at(static_cast<std::size_t>(servo.channel));
    servo_channels_.push_back(servo.channel);
    channel.motion.start(servo);
    channel.has_servo = true;
    // The controller comes up giving the pulse its servo stands at, as one that kept its power.
    channel.home = static_cast<std::uint16_t>(
        std::clamp(std::lround(servo.initial_setpoint / kQuarterMicrosecond), 0L,
                   static_cast<long>(kMaestroMaxValue)));
    channel.target = channel.home;
    channel.pulse = channel.home;
  }
}

void MaestroEmulator::receive(std::span<const std::uint8_t> bytes) {
  if (reset_.exchange(false)) lose_power();
  for (const std::uint8_t byte : bytes) {
    const std::uint64_t malformed = decoder_.malformed_bytes();
    const std::uint64_t crc_errors = decoder_.crc_errors();
    if (const auto request = decoder_.push(byte)) execute(*request);
    if (decoder_.malformed_bytes() != malformed) note_error(kSerialProtocolError);
    if (decoder_.crc_errors() != crc_errors) note_error(kSerialCrcError);
  }
  bytes_.store(decoder_.bytes(), std::memory_order_relaxed);
  malformed_.store(decoder_.malformed_bytes(), std::memory_order_relaxed);
}

void MaestroEmulator::note_error(MaestroError error) {
  errors_ |= error;
  if (board_.on_error == MaestroBoard::OnError::kIgnore) return;
  const bool off = board_.on_error == MaestroBoard::OnError::kOff;
  for (Channel& each : channels_) set_target(each, off ? std::uint16_t{0} : each.home);
}

void MaestroEmulator::note_silence() {
  if (board_.serial_timeout <= 0.0 || timed_out_) return;
  if (now_ - spoken_to_ < board_.serial_timeout) return;
  timed_out_ = true;
  note_error(kSerialTimeout);
}

void MaestroEmulator::lose_power() {
  decoder_.forget();
  replies_ = ReplyBuffer();
  errors_ = 0;
  for (Channel& channel : channels_) {
    channel.target = 0;
    channel.pulse = 0.0;
    channel.pulse_speed = 0.0;
    channel.speed_limit = 0.0;
    channel.acceleration_limit = 0.0;
  }
}

void MaestroEmulator::set_target(Channel& channel, std::uint16_t target) {
  // From "off" the first pulse jumps to its target: the controller does not know where the servo
  // is.
  if (channel.pulse == 0.0) channel.pulse = target;
  if (target == 0) {
    channel.pulse = 0.0;
    channel.pulse_speed = 0.0;
  }
  channel.target.store(target, std::memory_order_relaxed);
  targets_set_.fetch_add(1, std::memory_order_relaxed);
}

void MaestroEmulator::execute(const MaestroRequest& request) {
  spoken_to_ = now_;
  timed_out_ = false;
  Channel& channel = channels_[static_cast<std::size_t>(request.channel)];
  switch (request.command) {
    case MaestroCommand::kSetTarget:
    case MaestroCommand::kSetMultipleTargets:
      for (int i = 0; i < request.count; ++i) {
        set_target(channels_[static_cast<std::size_t>(request.channel + i)],
                   request.values[static_cast<std::size_t>(i)]);
      }
      break;
    case MaestroCommand::kSetSpeed:
      channel.speed_limit = request.values[0] / 10e-3;
      break;
    case MaestroCommand::kSetAcceleration:
      channel.acceleration_limit = request.values[0] / (10e-3 * 80e-3);
      break;
    case MaestroCommand::kGetPosition:
      reply(static_cast<std::uint16_t>(std::lround(channel.pulse)), 2);
      break;
    case MaestroCommand::kGetMovingState: {
      const bool moving = std::any_of(channels_.begin(), channels_.end(), [](const Channel& c) {
        return c.pulse != c.target.load(std::memory_order_relaxed);
      });
      reply(moving ? 1 : 0, 1);
      break;
    }
    case MaestroCommand::kGetErrors:
      reply(errors_, 2);
      errors_ = 0;
      break;
    case MaestroCommand::kGoHome:
      for (Channel& each : channels_) set_target(each, each.home);
      break;
  }
}

void MaestroEmulator::reply(std::uint16_t value, int bytes) {
  const std::array<std::uint8_t, 2> answer{static_cast<std::uint8_t>(value & 0xFF),
                                           static_cast<std::uint8_t>(value >> 8)};
  if (!replies_.add(std::span(answer).first(static_cast<std::size_t>(bytes)))) {
    note_error(kSerialBufferFull);
  }
}

void MaestroEmulator::ramp(Channel& channel) {
  const double target = channel.target.load(std::memory_order_relaxed);
  if (channel.speed_limit == 0.0 && channel.acceleration_limit == 0.0) {
    channel.pulse = target;
    return;
  }
  const double distance = target - channel.pulse;
  double speed = std::abs(distance) / ServoMotion::kStep;
  if (channel.speed_limit > 0.0) speed = std::min(speed, channel.speed_limit);
  if (channel.acceleration_limit > 0.0) {
    // Not faster than it can gain in one step, nor than it can still stop from.
    const double gained =
        std::abs(channel.pulse_speed) + channel.acceleration_limit * ServoMotion::kStep;
    const double stopping = std::sqrt(2.0 * channel.acceleration_limit * std::abs(distance));
    speed = std::min(
        {speed, gained, std::max(stopping, channel.acceleration_limit * ServoMotion::kStep)});
  }
  channel.pulse_speed = std::copysign(speed, distance);
  const double move = channel.pulse_speed * ServoMotion::kStep;
  channel.pulse = std::abs(move) >= std::abs(distance) ? target : channel.pulse + move;
}

void MaestroEmulator::advance_to(double time) {
  now_ = std::max(now_, time);
  note_silence();
  for (int step = clock_.steps_to(time); step > 0; --step) {
    for (Channel& channel : channels_) {
      if (!channel.has_servo) continue;
      ramp(channel);
      // Without pulses a hobby servo is limp and stays where it is.
      channel.pulse == 0.0 ? channel.motion.rest() : channel.motion.move(channel.pulse);
    }
  }
}

}  // namespace softfinger
