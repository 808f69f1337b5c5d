#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "softfinger/motors/servo_bus.hpp"

namespace softfinger {

/// One actuation point of a WEART TouchDIVER, by the WEART middleware over TCP. Its one set point
/// is a force from 0 to 1; 0 is sent as stopForce, and so is the end. What the middleware says of
/// the hand is read and not used: it knows no position of the cap that presses.
class WeartBus : public ServoBus {
 public:
  explicit WeartBus(const TransportSettings& transport);
  ~WeartBus() override { WeartBus::close(); }

  /// `port`: HOST:PORT. Waits a moment for the connection.
  [[nodiscard]] std::string open(const std::string& port) override;
  /// Lets go of the finger first.
  void close() noexcept override;
  [[nodiscard]] bool is_open() const noexcept override { return socket_ >= 0; }
  bool write(std::span<const std::int32_t> targets) noexcept override;
  bool ask() noexcept override { return false; }
  bool take_positions(std::span<std::int32_t>) noexcept override { return false; }
  void drain() noexcept override;

 private:
  void close_socket() noexcept;
  /// Hands over what waits; false: something still waits, or the connection is gone.
  bool flush() noexcept;
  bool send_text(std::string_view text) noexcept;

  ServoSettings point_;
  int socket_ = -1;
  std::array<char, 256> waiting_{};
  std::size_t waiting_from_ = 0;
  std::size_t waiting_to_ = 0;
};

}  // namespace softfinger
