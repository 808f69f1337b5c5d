#include "softfinger/sensing/force_sensor_emulator.hpp"

#include <algorithm>
#include <chrono>

#include "softfinger/sensing/force_message.hpp"

namespace softfinger {
namespace {

constexpr double kNoisy = 0.5;  // N

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

std::optional<double> FaultyForce::reading(double force) {
  const double noise = normal_(random_);
  const double half = 0.5 * hysteresis_;
  force = follows_ = std::clamp(follows_, (1.0 - half) * force, (1.0 + half) * force);
  switch (fault_.load()) {
    case ForceSensorFault::kSilent:
      return std::nullopt;
    case ForceSensorFault::kDead:
      return 0.0;
    case ForceSensorFault::kStuck:
      return last_;
    case ForceSensorFault::kReversed:
      return last_ = -force + noise_ * noise;
    case ForceSensorFault::kNoisy:
      return last_ = force + kNoisy * noise;
    case ForceSensorFault::kNone:
      break;
  }
  return last_ = force + noise_ * noise + 0.0;
}

ForceSensorEmulator::ForceSensorEmulator(const ForceSensorSettings& settings,
                                         const Endpoint& listener)
    : settings_(settings), says_(settings.noise, kSeed, settings.hysteresis), listener_(listener) {
  socket_.emplace(Endpoint{local_address_towards(listener.address), 0});
  thread_ = std::thread([this] { serve(); });
}

ForceSensorEmulator::ForceSensorEmulator(const ForceSensorSettings& settings)
    : settings_(settings), says_(settings.noise, kSeed, settings.hysteresis) {
  terminal_.emplace();
  thread_ = std::thread([this] { serve(); });
}

ForceSensorEmulator::~ForceSensorEmulator() {
  ending_ = true;
  thread_.join();
}

void ForceSensorEmulator::serve() {
  const std::chrono::duration<double> period(1.0 / settings_.rate);
  auto due = std::chrono::steady_clock::now();
  while (!ending_.load(std::memory_order_relaxed)) {
    if (const auto reading = says_.reading(force_.load())) send(*reading);
    due += std::chrono::duration_cast<std::chrono::steady_clock::duration>(period);
    std::this_thread::sleep_until(due);
  }
}

void ForceSensorEmulator::send(double reading) {
  if (settings_.kind == ForceSensorKind::kOsc) {
    socket_->send(listener_, encode_force_osc(reading));
    return;
  }
  const std::string line = encode_force_line(reading);
  if (terminal_) {
    terminal_->write(bytes_of(line));
  } else {
    socket_->send(listener_, bytes_of(line));
  }
}

}  // namespace softfinger
