#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "softfinger/motors/servo_bus.hpp"
#include "softfinger/motors/servo_table/frame_reader.hpp"
#include "softfinger/motors/servo_table/servo_protocol.hpp"
#include "softfinger/wire/line_clock.hpp"
#include "softfinger/wire/serial_port.hpp"

namespace softfinger {

/// A limit in whole units, not below what is wanted; 0 would be no limit.
[[nodiscard]] inline std::uint32_t at_least(double units, std::uint32_t most) {
  return static_cast<std::uint32_t>(std::clamp(std::ceil(units), 1.0, static_cast<double>(most)));
}

/// Servos with control tables on a serial bus: Dynamixel X series, Feetech STS and SMS.
///
/// open() finds every servo by its id, makes it stay where it is, writes what the device file asks
/// for into its table and turns its torque on. From then on each tick is one sync write of the
/// goals and one sync read of the positions; now and then the torque is read instead, or in turn
/// what else a servo tells of itself. A servo that lost its torque (it was reset, or protects
/// itself), or does not answer for a while, is one of faults(), and the others go on; all of them
/// together are a lost port: opening it again finds out who is left and where they stand.
///
/// Where servos have a watchdog it watches from the first write() on, until close().
class ServoTableBus : public ServoBus {
 public:
  /// A register that must have a value before torque is turned on.
  struct Preset {
    ServoRegister at;
    std::uint32_t value = 0;
    bool torque_off = false;  ///< can be written only while torque is off; lasts without power
  };

  /// `presets`: one list a servo; `clock` outlives the bus. Throws InputError where the line is too
  /// slow for the rate.
  ServoTableBus(std::unique_ptr<const ServoProtocol> protocol, const TransportSettings& transport,
                std::vector<std::vector<Preset>> presets, LineClock& clock);

  /// Waits for the servos' answers, a moment each.
  [[nodiscard]] std::string open(const std::string& port) override;
  void lead_those_left() noexcept override { those_left_ = true; }
  void close() noexcept override;
  [[nodiscard]] std::uint8_t complaints(std::size_t servo) const noexcept override {
    return static_cast<std::uint8_t>(complaints_[servo] | (hot_[servo] ? kTooHot : 0));
  }
  [[nodiscard]] ServoFaults faults() const noexcept override { return faults_; }
  [[nodiscard]] bool is_open() const noexcept override { return port_.is_open(); }
  bool write(std::span<const std::int32_t> targets) noexcept override;
  bool let_go() noexcept override;
  bool ask() noexcept override;
  bool take_positions(std::span<std::int32_t> positions) noexcept override;
  void drain() noexcept override { port_.drain(); }

 private:
  /// What the servos were asked for last.
  enum class Question : std::uint8_t { kPosition, kTorque, kWatchdog, kTemperature };
  struct Reply {
    bool came = false;
    std::uint8_t error = 0;
    std::uint32_t value = 0;
  };

  static constexpr int kTries = 10;  ///< of a servo that has answered before

  void check_speed(const TransportSettings& transport) const;
  bool send(const ServoFrame& frame) noexcept;
  /// The answer of the servo asked; `size`: of its data in bytes, where known.
  Reply exchange(const ServoFrame& request, std::optional<int> size, int tries = kTries);
  Reply read(std::uint8_t id, ServoRegister from);
  Reply write(std::uint8_t id, ServoRegister to, std::uint32_t value);
  /// Empty, or why not.
  [[nodiscard]] std::string find_servos();
  [[nodiscard]] std::string prepare(std::size_t servo);
  [[nodiscard]] std::string write_presets(std::size_t servo);
  void take(const ServoFrame& frame) noexcept;
  void count_silence() noexcept;
  /// What is asked for by turns.
  [[nodiscard]] Question next_question() const;
  [[nodiscard]] ServoRegister asked() const { return register_of(question_); }
  [[nodiscard]] ServoRegister register_of(Question question) const;
  /// The same to a register of every servo; false: not sent.
  bool tell_all(ServoRegister to, std::uint32_t value) noexcept;

  std::unique_ptr<const ServoProtocol> protocol_;
  LineClock& clock_;
  unsigned baud_;
  unsigned most_unanswered_;
  std::uint32_t watchdog_;  ///< as its register has it, while it watches
  int max_temperature_;     ///< degrees Celsius; 0: none is asked
  std::vector<std::uint8_t> ids_;
  std::vector<std::vector<Preset>> presets_;
  SerialPort port_;
  FrameReader reader_;
  Question question_ = Question::kPosition;
  std::vector<std::uint32_t> answers_;
  std::vector<bool> answered_;
  std::vector<std::uint8_t> complaints_;
  std::vector<bool> hot_;         ///< hotter than they may be
  bool watched_ = false;          ///< the watchdog was told to watch
  std::vector<unsigned> missed_;  ///< last questions in a row that a servo did not answer
  ServoFaults faults_;
  std::uint32_t limp_ = 0;   ///< or barked at, by the answers to the question under way
  bool those_left_ = false;  ///< see lead_those_left()
  bool known_ = false;       ///< positions of open() or of the last answer, not yet taken
  bool opened_ = false;      ///< nothing asked since open()
  unsigned asked_ = 0;       ///< questions since open()
};

}  // namespace softfinger
