#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "softfinger/base/name_table.hpp"
#include "softfinger/sensing/force_sensor_settings.hpp"
#include "softfinger/wire/endpoint.hpp"
#include "softfinger/wire/pseudo_terminal.hpp"
#include "softfinger/wire/udp_socket.hpp"

namespace softfinger {

/// What may be wrong with a force sensor.
enum class ForceSensorFault : std::uint8_t { kNone, kSilent, kDead, kStuck, kReversed, kNoisy };
inline constexpr std::array<NameRow<ForceSensorFault>, 6> kForceSensorFaults{{
    {ForceSensorFault::kNone, "none", "works"},
    {ForceSensorFault::kSilent, "silent", "says nothing"},
    {ForceSensorFault::kDead, "dead", "says zero"},
    {ForceSensorFault::kStuck, "stuck", "says what it said when that began"},
    {ForceSensorFault::kReversed, "reversed", "pulls where it is pressed"},
    {ForceSensorFault::kNoisy, "noisy", "with a noise of half a newton"},
}};

/// What a sensor with a fault, noise (N) and hysteresis (ForceSensorSettings) says of a force, N,
/// at least 0.
class FaultyForce {
 public:
  FaultyForce(double noise, std::uint64_t seed, double hysteresis = 0.0)
      : noise_(noise), hysteresis_(hysteresis), random_(seed) {}
  void fail(ForceSensorFault fault) { fault_.store(fault); }
  /// None: it is silent.
  [[nodiscard]] std::optional<double> reading(double force);

 private:
  double noise_, hysteresis_;
  double follows_ = 0.0;  ///< the force, N, with hysteresis
  std::atomic<ForceSensorFault> fault_{ForceSensorFault::kNone};
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  double last_ = 0.0;
};

/// The far end of a force sensor's wire, in wall time: sends what it is pressed with, in N, at the
/// settings' rate, with their noise, over UDP, OSC or a pseudo-terminal. A thread of its own.
class ForceSensorEmulator {
 public:
  static constexpr std::uint64_t kSeed = 1856;

  /// To a listener of a network.
  ForceSensorEmulator(const ForceSensorSettings& settings, const Endpoint& listener);
  /// Behind a pseudo-terminal. Throws OperationError where the system gives none.
  explicit ForceSensorEmulator(const ForceSensorSettings& settings);
  ~ForceSensorEmulator();
  ForceSensorEmulator(const ForceSensorEmulator&) = delete;
  ForceSensorEmulator& operator=(const ForceSensorEmulator&) = delete;

  /// It is pressed with this, N. Any thread.
  void press(double force) { force_.store(force); }
  void fail(ForceSensorFault fault) { says_.fail(fault); }
  /// Of the pseudo-terminal; empty for a network.
  [[nodiscard]] std::string port() const { return terminal_ ? terminal_->name() : std::string(); }

 private:
  void serve();
  void send(double reading);

  ForceSensorSettings settings_;
  FaultyForce says_;
  Endpoint listener_;
  std::optional<UdpSocket> socket_;
  std::optional<PseudoTerminal> terminal_;
  std::atomic<double> force_{0.0};
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace softfinger
