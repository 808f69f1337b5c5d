#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>

#include "softfinger/sensing/force_message.hpp"
#include "softfinger/sensing/force_sensor_settings.hpp"
#include "softfinger/threads/mailbox.hpp"
#include "softfinger/wire/serial_port.hpp"
#include "softfinger/wire/udp_socket.hpp"

namespace softfinger {

class ForceSensorEmulator;

/// What a force sensor has said so far.
struct ForceSample {
  double force = 0.0;                                          ///< newest, N
  double received = -std::numeric_limits<double>::infinity();  ///< of that, s, monotonic clock
  double sum = 0.0;           ///< of all forces, N: two looks tell the mean between them
  std::uint64_t count = 0;    ///< of these
  std::uint64_t refused = 0;  ///< what came and was no force: no number, or beyond kLargestForce
};

/// A force sensor that sends by itself: over a network or a serial line. A thread of its own, of no
/// priority, receives. A serial port that goes away is opened again. The first sender over a
/// network keeps the port until it is silent for `stale`. With an emulated far end that is within.
class ForceSensor {
 public:
  /// The kind is not kEmulator. Throws InputError where the port cannot be opened.
  explicit ForceSensor(const ForceSensorSettings& settings);
  ~ForceSensor();
  ForceSensor(const ForceSensor&) = delete;
  ForceSensor& operator=(const ForceSensor&) = delete;

  /// The newest; wait-free. One thread.
  [[nodiscard]] const ForceSample& look();
  /// Whether the newest reading counts at `now` (s, monotonic clock).
  [[nodiscard]] bool is_fresh(const ForceSample& sample, double now) const {
    return now - sample.received <= settings_.stale;
  }
  [[nodiscard]] const ForceSensorSettings& settings() const { return settings_; }
  /// What is at the far end; null: a real one.
  [[nodiscard]] ForceSensorEmulator* emulator() { return emulator_.get(); }
  /// Where it listens.
  [[nodiscard]] const std::string& port() const { return port_; }

 private:
  void open();
  void serve();
  void serve_network();
  void serve_serial();
  void take(std::optional<double> reading);

  ForceSensorSettings settings_;
  std::string port_;
  std::unique_ptr<ForceSensorEmulator> emulator_;
  std::optional<UdpSocket> socket_;
  SerialPort serial_;
  ForceSample sample_;  ///< the thread's
  Mailbox<ForceSample> newest_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace softfinger
