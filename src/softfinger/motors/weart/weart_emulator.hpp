#pragma once

#include <atomic>
#include <string>

#include "softfinger/motors/emulation/bus_emulator.hpp"
#include "softfinger/motors/emulation/emulated_servo.hpp"
#include "softfinger/motors/transport_settings.hpp"
#include "softfinger/motors/weart/weart_protocol.hpp"

namespace softfinger {

/// The WEART middleware with one TouchDIVER thimble: takes forces between start and stop, for one
/// actuation point, and says what it does as the middleware does, in JSON.
class WeartEmulator : public BusEmulator {
 public:
  WeartEmulator(const TransportSettings& transport, const EmulatedServo& point);

  void receive(std::span<const std::uint8_t> bytes) override;
  std::size_t take_replies(std::span<std::uint8_t> out) override { return replies_.take(out); }
  void advance_to(double time) override;
  [[nodiscard]] double setpoint(std::size_t) const override { return motion_.setpoint(); }

  [[nodiscard]] std::uint64_t commands() const { return commands_; }
  [[nodiscard]] std::uint64_t stops() const { return stops_; }
  [[nodiscard]] bool started() const { return started_; }
  /// Messages that were none, or not for this point, or came before the start.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }
  [[nodiscard]] double largest() const { return largest_; }

 private:
  void execute(const WeartRequest& request);

  std::string address_;
  WeartReader reader_;
  ReplyBuffer replies_;
  ServoMotion motion_;
  ServoClock clock_;
  double wanted_ = 0.0;
  std::uint64_t wrong_ = 0;
  std::atomic<bool> started_{false};
  std::atomic<std::uint64_t> commands_{0}, stops_{0}, refused_{0};
  std::atomic<double> largest_{0.0};
};

}  // namespace softfinger
