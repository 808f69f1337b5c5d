#pragma once

#include <vector>

#include "softfinger/motors/servo_bus.hpp"

namespace softfinger {

/// Set points by Open Sound Control over UDP: one bundle a command, one message with one float a
/// servo. Nobody says whether they arrive, nor where the servos are.
class OscBus : public ServoBus {
 public:
  explicit OscBus(const TransportSettings& transport);
  ~OscBus() override { close_socket(); }

  /// `port`: HOST:PORT.
  [[nodiscard]] std::string open(const std::string& port) override;
  void close() noexcept override { close_socket(); }
  [[nodiscard]] bool is_open() const noexcept override { return socket_ >= 0; }
  bool write(std::span<const std::int32_t> targets) noexcept override;
  bool ask() noexcept override { return false; }
  bool take_positions(std::span<std::int32_t>) noexcept override { return false; }
  void drain() noexcept override {}

 private:
  void close_socket() noexcept;

  std::vector<ServoSettings> servos_;
  std::vector<std::uint8_t> bytes_;
  int socket_ = -1;
};

}  // namespace softfinger
