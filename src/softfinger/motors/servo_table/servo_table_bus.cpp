#include "softfinger/motors/servo_table/servo_table_bus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

constexpr std::chrono::milliseconds kStatusTime{100};
constexpr int kPingTries = 5;
/// Every so many questions are about the torque, and halfway between about something else.
constexpr unsigned kTorqueEvery = 8;
/// What the watchdog waits for at least, s, and in ticks: a busy machine is no dead one.
constexpr double kWatchdogTime = 1.0;
constexpr double kWatchdogTicks = 5.0;
/// So many questions in a row without all answers, and for half a second, are a lost bus.
constexpr unsigned kMostUnanswered = 20;
/// What a servo may wait before it answers (factory setting), s.
constexpr double kReturnDelay = 500e-6;

}  // namespace

ServoTableBus::ServoTableBus(std::unique_ptr<const ServoProtocol> protocol,
                             const TransportSettings& transport,
                             std::vector<std::vector<Preset>> presets, LineClock& clock)
    : protocol_(std::move(protocol)),
      clock_(clock),
      baud_(static_cast<unsigned>(transport.baud)),
      most_unanswered_(std::max(kMostUnanswered, static_cast<unsigned>(transport.rate / 2.0))),
      watchdog_(at_least(std::max(kWatchdogTime, kWatchdogTicks / transport.rate) / kWatchdogUnit,
                         kMostWatchdog)),
      max_temperature_(transport.max_temperature),
      presets_(std::move(presets)),
      reader_(*protocol_) {
  for (const ServoSettings& servo : transport.servos) {
    ids_.push_back(static_cast<std::uint8_t>(servo.channel));
  }
  answers_.resize(ids_.size());
  answered_.resize(ids_.size());
  missed_.resize(ids_.size());
  complaints_.resize(ids_.size());
  hot_.resize(ids_.size());
  check_speed(transport);
}

void ServoTableBus::check_speed(const TransportSettings& transport) const {
  const ControlTable& table = protocol_->table();
  std::array<std::uint8_t, ServoProtocol::kMostBytes> bytes;
  const std::vector<std::uint32_t> goals(ids_.size());
  const std::array<std::uint8_t, ServoProtocol::kMostBytes> data{};
  const std::size_t answer = std::max(table.present.size, table.torque_question.size);
  const std::size_t count =
      protocol_->encode(sync_write_request(*protocol_, table.goal, ids_, goals), bytes) +
      protocol_->encode(sync_read_request(*protocol_, table.present, ids_), bytes) +
      ids_.size() *
          protocol_->encode(protocol_->status_frame(0, 0, std::span(data).first(answer)), bytes);
  const double time = SerialPort::kBitsPerByte * static_cast<double>(count) / transport.baud +
                      kReturnDelay * static_cast<double>(ids_.size());
  if (time * transport.rate <= 1.0) return;
  throw InputError(
      fmt::format("transport.rate_Hz: {:g} ticks a second leave {:.3g} ms each, but {} servos at "
                  "{} baud need {:.3g} ms; lower rate_Hz, or set servos and file to more baud",
                  transport.rate, 1e3 / transport.rate, ids_.size(), transport.baud, 1e3 * time));
}

bool ServoTableBus::send(const ServoFrame& frame) noexcept {
  std::array<std::uint8_t, ServoProtocol::kMostBytes> bytes;
  const std::size_t size = protocol_->encode(frame, bytes);
  return port_.write(std::span(bytes).first(size)) == SerialPort::Result::kSent;
}

ServoTableBus::Reply ServoTableBus::exchange(const ServoFrame& request, std::optional<int> size,
                                             int tries) {
  Reply reply;
  for (int i = 0; i < tries && !reply.came && port_.is_open(); ++i) {
    // An answer that came too late must not be taken for that to the next question.
    if (i > 0) clock_.sleep_for(kStatusTime);
    port_.discard_input();
    reader_.reset();
    if (!send(request)) continue;
    const LineClock::TimePoint until = clock_.now() + kStatusTime;
    while (!reply.came && port_.is_open() && clock_.now() < until) {
      std::array<std::uint8_t, 64> bytes;
      port_.await_kernel();
      const std::size_t got = port_.read(bytes);
      reader_.push(std::span(bytes).first(got), [&](const ServoFrame& frame) {
        const auto status = protocol_->status(frame);
        if (!status || status->id != request.id) return;
        const bool fits = !size || static_cast<int>(status->data.size()) == *size;
        if (fits || status->error != 0) {
          reply = {true, status->error, register_value(status->data)};
        }
      });
      if (got == 0) clock_.sleep_for(std::chrono::microseconds(300));
    }
  }
  return reply;
}

ServoTableBus::Reply ServoTableBus::read(std::uint8_t id, ServoRegister from) {
  return exchange(read_request(*protocol_, id, from), from.size);
}

ServoTableBus::Reply ServoTableBus::write(std::uint8_t id, ServoRegister to, std::uint32_t value) {
  return exchange(write_request(*protocol_, id, to, value), 0);
}

std::string ServoTableBus::find_servos() {
  const std::uint64_t bytes = reader_.bytes();
  const std::uint64_t frames = reader_.frames();
  std::vector<int> silent;
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    // Where nobody has answered so far nobody will: no more patience for the rest.
    const bool hope = silent.size() < 2 || reader_.frames() != frames;
    if (!exchange(ping_request(ids_[i]), std::nullopt, hope ? kPingTries : 1).came) {
      silent.push_back(ids_[i]);
      faults_.silent |= 1U << i;
    }
    if (!port_.is_open()) return "it vanished";
  }
  if (silent.empty()) return {};
  if (reader_.frames() == frames && reader_.bytes() != bytes) {
    return fmt::format("bytes came but no valid frame; are the servos set to {} baud?", baud_);
  }
  const std::string ids = fmt::format("{}", fmt::join(silent, ", "));
  if (silent.size() == ids_.size()) {
    return fmt::format(
        "no servo answers (id {}); check power, wiring, ids and whether the servos "
        "are set to {} baud",
        ids, baud_);
  }
  if (those_left_) return {};
  return fmt::format("id {} did not answer, the others did; check ids and wiring", ids);
}

std::string ServoTableBus::write_presets(std::size_t servo) {
  const std::uint8_t id = ids_[servo];
  bool torque_off = false;
  // One that has barked takes no goal, and one that watches would bark while others are asked.
  if (const ServoRegister watchdog = protocol_->table().watchdog; watchdog.size != 0) {
    write(id, watchdog, 0);
  }
  for (const Preset& preset : presets_[servo]) {
    const Reply now = read(id, preset.at);
    if (now.came && now.error == 0 && now.value == preset.value) continue;
    if (preset.torque_off && !torque_off) {
      write(id, protocol_->table().torque, 0);
      torque_off = true;
    }
    const Reply reply = write(id, preset.at, preset.value);
    if (!reply.came) return fmt::format("servo {} answers no more", id);
    if (reply.error != 0) {
      return fmt::format("servo {} does not take {} at address {} of its control table (error {})",
                         id, preset.value, preset.at.address, reply.error);
    }
    const Reply kept = read(id, preset.at);
    if (!kept.came || kept.value != preset.value) {
      return fmt::format("servo {} does not keep {} at address {} of its control table", id,
                         preset.value, preset.at.address);
    }
  }
  return {};
}

std::string ServoTableBus::prepare(std::size_t servo) {
  const std::uint8_t id = ids_[servo];
  const ControlTable& table = protocol_->table();
  std::string reason = write_presets(servo);
  if (!reason.empty()) return reason;
  const Reply present = read(id, table.present);
  if (!present.came || present.error != 0)
    return fmt::format("servo {} does not say where it is", id);
  // The servo must stay where it is when its torque comes. A goal out of its limits is refused,
  // and where the servo itself takes the present position as its goal this is not needed.
  write(id, table.goal, present.value);
  const Reply torque = write(id, table.torque, 1);
  if (!torque.came) return fmt::format("servo {} answers no more", id);
  if (torque.error != 0) {
    return fmt::format("servo {} does not turn its torque on (error {}); does it protect itself?",
                       id, torque.error);
  }
  answers_[servo] = present.value;
  return {};
}

std::string ServoTableBus::open(const std::string& port) {
  std::string reason = port_.open(port, baud_);
  if (!reason.empty()) return reason;
  faults_ = {};
  watched_ = false;
  std::fill(complaints_.begin(), complaints_.end(), std::uint8_t{0});
  std::fill(hot_.begin(), hot_.end(), false);
  reason = find_servos();
  std::size_t ready = 0;
  std::string refused;
  for (std::size_t i = 0; i < ids_.size() && reason.empty(); ++i) {
    if (faults_.has(i)) continue;
    const std::string not_ready = prepare(i);
    if (not_ready.empty()) {
      ++ready;
    } else if (those_left_ && port_.is_open()) {
      faults_.limp |= 1U << i;
      refused = not_ready;
    } else {
      reason = not_ready;
    }
  }
  if (reason.empty() && ready == 0) reason = refused;
  if (!reason.empty()) {
    port_.close();
    return reason;
  }
  opened_ = true;
  known_ = true;
  asked_ = 0;
  std::fill(missed_.begin(), missed_.end(), 0U);
  std::fill(answered_.begin(), answered_.end(), true);
  question_ = Question::kPosition;
  return {};
}

void ServoTableBus::close() noexcept {
  // Whoever opens the port next may not know of watchdogs.
  if (watched_ && port_.is_open()) tell_all(protocol_->table().watchdog, 0);
  port_.close();
}

bool ServoTableBus::tell_all(ServoRegister to, std::uint32_t value) noexcept {
  std::array<std::uint32_t, kMostServos> values;
  values.fill(value);
  return send(sync_write_request(*protocol_, to, ids_, std::span(values).first(ids_.size())));
}

bool ServoTableBus::write(std::span<const std::int32_t> targets) noexcept {
  std::array<std::uint8_t, kMostServos> ids;
  std::array<std::uint32_t, kMostServos> values;
  std::size_t count = 0;
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    if (faults_.has(i)) continue;
    ids[count] = ids_[i];
    values[count++] = protocol_->to_register(targets[i]);
  }
  const bool sent =
      send(sync_write_request(*protocol_, protocol_->table().goal, std::span(ids).first(count),
                              std::span(values).first(count)));
  const ServoRegister watchdog = protocol_->table().watchdog;
  if (sent && !watched_ && watchdog.size != 0) watched_ = tell_all(watchdog, watchdog_);
  return sent;
}

bool ServoTableBus::let_go() noexcept {
  // Those that are lost too: a servo that has no voice may still have ears.
  return tell_all(protocol_->table().torque, 0);
}

ServoRegister ServoTableBus::register_of(Question question) const {
  const ControlTable& table = protocol_->table();
  switch (question) {
    case Question::kPosition:
      return table.present;
    case Question::kTorque:
      return table.torque_question;
    case Question::kWatchdog:
      return table.watchdog_question;
    case Question::kTemperature:
      return max_temperature_ > 0 ? table.temperature_question : ServoRegister{};
  }
  return {};
}

ServoTableBus::Question ServoTableBus::next_question() const {
  if (asked_ % kTorqueEvery == 0) return Question::kTorque;
  if (asked_ % kTorqueEvery != kTorqueEvery / 2) return Question::kPosition;
  constexpr std::array kByTurns{Question::kWatchdog, Question::kTemperature};
  const Question next = kByTurns[asked_ / kTorqueEvery % kByTurns.size()];
  return register_of(next).size != 0 ? next : Question::kPosition;
}

/// Of the last question.
void ServoTableBus::count_silence() noexcept {
  bool heard = false;
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    if (faults_.has(i)) continue;
    missed_[i] = answered_[i] ? 0 : missed_[i] + 1;
    heard = heard || missed_[i] <= most_unanswered_;
  }
  if (!heard) return port_.close();  // who is left is found out anew
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    if (faults_.has(i) || missed_[i] <= most_unanswered_) continue;
    faults_.silent |= 1U << i;
    // Those behind it may only have waited for it, and are asked without it now.
    std::fill(missed_.begin(), missed_.end(), 0U);
    return;
  }
}

bool ServoTableBus::ask() noexcept {
  if (opened_) {  // open() has just asked
    opened_ = false;
    return true;
  }
  count_silence();
  if (!port_.is_open()) return true;
  ++asked_;
  question_ = next_question();
  known_ = false;
  limp_ = 0;
  reader_.reset();  // half an answer belongs to the last question
  std::array<std::uint8_t, kMostServos> ids;
  std::size_t count = 0;
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    answered_[i] = faults_.has(i);
    if (!answered_[i]) ids[count++] = ids_[i];
  }
  send(sync_read_request(*protocol_, asked(), std::span(ids).first(count)));
  return true;
}

void ServoTableBus::take(const ServoFrame& frame) noexcept {
  const auto status = protocol_->status(frame);
  // The size tells a late answer to the question before.
  if (!status || status->data.size() != asked().size) return;
  if (status->error != 0 && !protocol_->table().errors_in_status) return;
  const auto found = std::find(ids_.begin(), ids_.end(), status->id);
  if (found == ids_.end()) return;
  const auto servo = static_cast<std::size_t>(found - ids_.begin());
  const ControlTable& table = protocol_->table();
  const auto value_of = [&](ServoRegister at) {
    return register_value(status->data.subspan(at.address - asked().address, at.size));
  };
  if (table.errors_in_status) complaints_[servo] = protocol_->complaints(status->error);
  switch (question_) {
    case Question::kPosition:
      answers_[servo] = value_of(table.present);
      break;
    case Question::kTorque:
      if (value_of(table.torque) == 0) limp_ |= 1U << servo;
      if (!table.errors_in_status) {
        complaints_[servo] = protocol_->complaints(value_of(table.errors));
      }
      break;
    case Question::kWatchdog:
      if (value_of(table.watchdog) == kWatchdogBarked) limp_ |= 1U << servo;
      break;
    case Question::kTemperature:
      hot_[servo] = static_cast<int>(value_of(table.temperature)) > max_temperature_;
      break;
  }
  answered_[servo] = true;
  if (!std::all_of(answered_.begin(), answered_.end(), [](bool one) { return one; })) return;
  known_ = question_ == Question::kPosition;
  if (limp_ == 0) return;
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    if (faults_.has(i) || ((limp_ >> i) & 1U) != 0) continue;
    faults_.limp |= limp_;
    return;
  }
  port_.close();  // all of them: a board that was reset
}

bool ServoTableBus::take_positions(std::span<std::int32_t> positions) noexcept {
  std::array<std::uint8_t, 256> bytes;
  std::size_t got = 0;
  do {
    got = port_.read(bytes);
    reader_.push(std::span(bytes).first(got), [this](const ServoFrame& frame) { take(frame); });
  } while (got == bytes.size());
  if (!known_ || !port_.is_open()) return false;
  known_ = false;
  for (std::size_t i = 0; i < ids_.size(); ++i) positions[i] = protocol_->to_position(answers_[i]);
  return true;
}

}  // namespace softfinger
