#include "softfinger/motors/servo_table/servo_table_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"
#include "softfinger/motors/feetech/feetech_protocol.hpp"

namespace softfinger {
namespace {

/// Model of an XM430-W350.
constexpr std::uint32_t kModel = 1020;
constexpr ServoRegister kModelAt{0, 2};
constexpr std::int32_t kLastTick = 4095;

}  // namespace

ServoTableEmulator::ServoTableEmulator(std::unique_ptr<const ServoProtocol> protocol,
                                       std::span<const EmulatedServo> servos)
    : protocol_(std::move(protocol)),
      servos_(servos.size()),
      reader_(*protocol_),
      dynamixel_(dynamic_cast<const DynamixelProtocol*>(protocol_.get()) != nullptr),
      least_goal_(std::numeric_limits<std::int32_t>::max()),
      largest_goal_(std::numeric_limits<std::int32_t>::min()) {
  for (std::size_t i = 0; i < servos.size(); ++i) {
    Servo& servo = servos_[i];
    servo.id = static_cast<std::uint8_t>(servos[i].channel);
    servo.motion.start(servos[i]);
    if (dynamixel_) {
      put(servo, kModelAt, kModel);
      put(servo, dynamixel::kOperatingMode, dynamixel::kPositionMode);
      put(servo, dynamixel::kCurrentLimit, 1193);
      put(servo, dynamixel::kMaxPosition, kLastTick);
    }
    note_position(servo);
    servo.goal = protocol_->to_position(get(servo, protocol_->table().present));
  }
}

void ServoTableEmulator::turn(std::size_t servo, double setpoint) {
  EmulatedServo turned = servos_[servo].motion.servo();
  turned.initial_setpoint = setpoint;
  servos_[servo].motion.start(turned);
  note_position(servos_[servo]);
  servos_[servo].goal = protocol_->to_position(get(servos_[servo], protocol_->table().present));
}

void ServoTableEmulator::receive(std::span<const std::uint8_t> bytes) {
  if (reset_.exchange(false)) lose_power();
  for (Servo& servo : servos_) {
    if (!servo.tripped.exchange(false)) continue;
    servo.torque = false;
    put(servo, protocol_->table().torque, 0);
  }
  reader_.push(bytes, [this](const ServoFrame& frame) { execute(frame); });
  frames_ = reader_.frames();
  malformed_ = reader_.malformed_bytes();
}

void ServoTableEmulator::lose_power() {
  reader_.reset();
  for (Servo& servo : servos_) {
    servo.torque = false;
    put(servo, protocol_->table().torque, 0);
    if (dynamixel_) {
      put(servo, dynamixel::kGoalCurrent, 0);
      put(servo, protocol_->table().watchdog, 0);
      servo.barked = false;
      put(servo, dynamixel::kProfileVelocity, 0);
      put(servo, dynamixel::kProfileAcceleration, 0);
    } else {
      put(servo, feetech::kSpeed, 0);
      put(servo, feetech::kAcceleration, 0);
    }
    servo.motion.limit_rate(0.0);
  }
}

void ServoTableEmulator::put(Servo& servo, ServoRegister at, std::uint32_t value) {
  for (std::size_t i = 0; i < at.size; ++i) {
    servo.memory[at.address + i] = static_cast<std::uint8_t>((value >> (8 * i)) & 0xFF);
  }
}

std::uint32_t ServoTableEmulator::get(const Servo& servo, ServoRegister at) const {
  return register_value(std::span(servo.memory).subspan(at.address, at.size));
}

void ServoTableEmulator::note_position(Servo& servo) {
  const double ticks = servo.motion.setpoint() / servo.motion.servo().step;
  put(servo, protocol_->table().present,
      protocol_->to_register(static_cast<std::int32_t>(std::lround(ticks))));
}

void ServoTableEmulator::answer(std::uint8_t id, std::uint8_t error,
                                std::span<const std::uint8_t> data) {
  std::array<std::uint8_t, ServoProtocol::kMostBytes> bytes;
  const std::size_t size = protocol_->encode(protocol_->status_frame(id, error, data), bytes);
  replies_.add(std::span(bytes).first(size));
}

void ServoTableEmulator::answer_read(Servo& servo, std::size_t address, std::size_t length) {
  // A status carries its error besides.
  if (length == 0 || length >= ServoFrame::kMostParameters / 2 ||
      address + length > servo.memory.size()) {
    return answer(servo.id, dynamixel::kRangeError, {});
  }
  note_position(servo);
  const ControlTable& table = protocol_->table();
  put(servo, table.errors, servo.errors);
  put(servo, table.temperature, servo.temperature);
  answer(servo.id, table.errors_in_status ? servo.errors.load() : std::uint8_t{0},
         std::span(servo.memory).subspan(address, length));
}

std::uint8_t ServoTableEmulator::write(Servo& servo, std::size_t address,
                                       std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return dynamixel::kLengthError;
  if (address + bytes.size() > servo.memory.size()) return dynamixel::kRangeError;
  const ControlTable& table = protocol_->table();
  if (dynamixel_ && address < dynamixel::kFirstVolatile && servo.torque) {
    return dynamixel::kAccessError;
  }
  const bool watchdog = table.watchdog.size != 0 && address == table.watchdog.address;
  if (watchdog && bytes[0] > kMostWatchdog) return dynamixel::kRangeError;
  if (servo.barked && address == table.goal.address) return dynamixel::kRangeError;
  if (watchdog && bytes[0] == 0) servo.barked = false;
  if (watchdog && servo.barked) return dynamixel::kRangeError;
  const bool goal = address == table.goal.address && bytes.size() >= table.goal.size;
  if (goal) {
    const std::int32_t position =
        protocol_->to_position(register_value(bytes.first(table.goal.size)));
    if (dynamixel_ && get(servo, dynamixel::kOperatingMode) == dynamixel::kPositionMode &&
        (position < static_cast<std::int32_t>(get(servo, dynamixel::kMinPosition)) ||
         position > static_cast<std::int32_t>(get(servo, dynamixel::kMaxPosition)))) {
      return dynamixel::kLimitError;
    }
    servo.goal = position;
  }
  if (dynamixel_ && address < dynamixel::kFirstVolatile) ++lasting_writes_;
  std::copy(bytes.begin(), bytes.end(),
            servo.memory.begin() + static_cast<std::ptrdiff_t>(address));
  if (forgotten_.size != 0 && address == forgotten_.address) put(servo, forgotten_, 0);
  servo.motion.limit_rate(dynamixel_ ? get(servo, dynamixel::kProfileVelocity) *
                                           dynamixel::kProfileVelocityUnit
                                     : get(servo, feetech::kSpeed));
  if (address <= table.torque.address && table.torque.address < address + bytes.size()) {
    const bool on = get(servo, table.torque) == 1;
    if (on && !servo.torque && dynamixel_) {
      note_position(servo);
      servo.goal = protocol_->to_position(get(servo, table.present));
    }
    servo.torque = on;
  }
  return 0;
}

void ServoTableEmulator::hear_nothing(Servo& servo) {
  const ServoRegister watchdog = protocol_->table().watchdog;
  if (watchdog.size == 0 || !servo.torque || servo.barked) return;
  const std::uint32_t patience = get(servo, watchdog);
  ++servo.unheard;
  if (patience == 0 || servo.unheard * ServoMotion::kStep <= patience * kWatchdogUnit) return;
  put(servo, watchdog, kWatchdogBarked);
  servo.barked = true;
  note_position(servo);
  servo.goal = protocol_->to_position(get(servo, protocol_->table().present));
}

void ServoTableEmulator::execute(const ServoFrame& frame) {
  for (Servo& servo : servos_) {
    if (!servo.cut_off) servo.unheard = 0;
  }
  const auto a = static_cast<std::size_t>(protocol_->table().address_bytes);
  const std::span<const std::uint8_t> used = frame.used();
  const auto number = [&](std::size_t at) -> std::size_t {
    return register_value(used.subspan(at, a));
  };
  const auto instruction = static_cast<ServoInstruction>(frame.code);
  if (instruction == ServoInstruction::kSyncRead || instruction == ServoInstruction::kSyncWrite) {
    if (frame.id != kEveryServo || frame.size < 2 * a) return;
    const std::size_t address = number(0);
    const std::size_t length = number(a);
    const bool writes = instruction == ServoInstruction::kSyncWrite;
    const std::size_t stride = 1 + (writes ? length : 0);
    if ((frame.size - 2 * a) % stride != 0) return;
    if (writes && address == protocol_->table().goal.address) ++commands_;
    for (std::size_t at = 2 * a; at < frame.size; at += stride) {
      for (Servo& servo : servos_) {
        if (servo.id != used[at]) continue;
        if (servo.cut_off && !writes) return;
        if (servo.cut_off) continue;
        if (!writes) {
          answer_read(servo, address, length);
          continue;
        }
        const auto bytes = used.subspan(at + 1, length);
        if (address == protocol_->table().goal.address && length >= protocol_->table().goal.size) {
          const std::int32_t goal =
              protocol_->to_position(register_value(bytes.first(protocol_->table().goal.size)));
          least_goal_ = std::min(least_goal_.load(), goal);
          largest_goal_ = std::max(largest_goal_.load(), goal);
        }
        write(servo, address, bytes);
      }
    }
    return;
  }
  for (Servo& servo : servos_) {
    if (servo.id != frame.id || servo.cut_off) continue;
    if (instruction == ServoInstruction::kPing) {
      // Only a Dynamixel says its model and firmware.
      const std::array<std::uint8_t, 3> model{kModel & 0xFF, kModel >> 8, 46};
      answer(servo.id, 0, std::span(model).first(dynamixel_ ? 3 : 0));
    } else if (instruction == ServoInstruction::kRead) {
      if (frame.size != 2 * a) return answer(servo.id, dynamixel::kLengthError, {});
      answer_read(servo, number(0), number(a));
    } else if (instruction == ServoInstruction::kWrite) {
      if (frame.size < a) return answer(servo.id, dynamixel::kLengthError, {});
      answer(servo.id, write(servo, number(0), used.subspan(a)), {});
    } else {
      answer(servo.id, dynamixel::kInstructionError, {});
    }
  }
}

void ServoTableEmulator::advance_to(double time) {
  for (int step = clock_.steps_to(time); step > 0; --step) {
    for (Servo& servo : servos_) {
      hear_nothing(servo);
      servo.torque && !servo.blocked ? servo.motion.move(servo.goal) : servo.motion.rest();
    }
  }
}

}  // namespace softfinger
