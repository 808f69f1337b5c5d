#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "softfinger/motors/emulation/bus_emulator.hpp"
#include "softfinger/motors/emulation/emulated_servo.hpp"
#include "softfinger/motors/transport_settings.hpp"

namespace softfinger {

/// What listens to an OscBus: takes bundles of the device's addresses and nothing else.
class OscEmulator : public BusEmulator {
 public:
  /// One emulated servo for each of the transport's.
  OscEmulator(const TransportSettings& transport, std::span<const EmulatedServo> servos);

  /// One datagram.
  void receive(std::span<const std::uint8_t> datagram) override;
  std::size_t take_replies(std::span<std::uint8_t>) override { return 0; }
  void advance_to(double time) override;
  [[nodiscard]] double setpoint(std::size_t servo) const override {
    return servos_[servo].motion.setpoint();
  }

  [[nodiscard]] std::uint64_t bundles() const { return bundles_; }
  /// Datagrams that were no bundle of all the addresses.
  [[nodiscard]] std::uint64_t malformed() const { return malformed_; }
  /// Least and largest number of a servo so far.
  [[nodiscard]] double least(std::size_t servo) const { return servos_[servo].least; }
  [[nodiscard]] double largest(std::size_t servo) const { return servos_[servo].largest; }

 private:
  struct Servo {
    std::string address;
    ServoMotion motion;
    double wanted = 0.0;  ///< set point
    std::atomic<double> least{1e300}, largest{-1e300};
  };

  /// Into numbers_; false where it is no bundle of one finite number for each servo.
  bool read(std::span<const std::uint8_t> datagram);

  std::vector<Servo> servos_;
  std::vector<double> numbers_;  ///< of the datagram
  ServoClock clock_;
  std::atomic<std::uint64_t> bundles_{0}, malformed_{0};
};

}  // namespace softfinger
