#include "softfinger/sensing/force_sensor.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/sensing/force_port.hpp"
#include "softfinger/sensing/force_sensor_emulator.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

constexpr double kLookUpEvery = 0.05;                 // s, whether the end has come
constexpr std::chrono::milliseconds kSerialPause{2};  // between looks at a serial line
constexpr double kOpenEvery = 0.3;                    // s, a port that went away

}  // namespace

ForceSensor::ForceSensor(const ForceSensorSettings& settings) : settings_(settings) {
  open();
  thread_ = std::thread([this] { serve(); });
}

ForceSensor::~ForceSensor() {
  ending_ = true;
  thread_.join();
}

void ForceSensor::open() {
  if (is_network(settings_.kind)) {
    Endpoint own;
    const std::string why = force_endpoint(settings_, own);
    if (!why.empty()) throw InputError("force_sensor.port: " + why);
    socket_.emplace(own);
    port_ = text_of(socket_->local());
    if (settings_.is_emulated()) {
      emulator_ = std::make_unique<ForceSensorEmulator>(settings_, socket_->local());
    }
    return;
  }
  port_ = settings_.port;
  if (settings_.is_emulated()) {
    emulator_ = std::make_unique<ForceSensorEmulator>(settings_);
    port_ = emulator_->port();
  }
  const std::string why = serial_.open(port_, settings_.baud);
  if (!why.empty()) {
    throw InputError(
        fmt::format("force_sensor.port: {} cannot be opened: {}; connect it, name "
                    "another, or use port = \"emulator\"",
                    port_, why));
  }
}

const ForceSample& ForceSensor::look() {
  newest_.refresh();
  return newest_.latest();
}

void ForceSensor::take(std::optional<double> reading) {
  const double force = reading ? settings_.force(*reading) : 0.0;
  if (!reading || !(std::abs(force) <= ForceSensorSettings::kLargestForce)) {
    ++sample_.refused;
  } else {
    sample_.force = force;
    sample_.received = monotonic_time();
    sample_.sum += force;
    ++sample_.count;
  }
  newest_.draft() = sample_;
  newest_.publish();
}

void ForceSensor::serve() {
  if (is_network(settings_.kind)) {
    serve_network();
  } else {
    serve_serial();
  }
}

void ForceSensor::serve_network() {
  std::vector<std::uint8_t> buffer(kLargestDatagram);
  const std::array<int, 1> sockets{socket_->descriptor()};
  std::optional<Endpoint> sender;
  while (!ending_.load(std::memory_order_relaxed)) {
    wait_for_datagram(sockets, kLookUpEvery);
    while (const auto datagram = socket_->receive(buffer)) {
      if (ending_.load(std::memory_order_relaxed)) return;
      if (!sender || (datagram->from != *sender && !is_fresh(sample_, monotonic_time()))) {
        sender = datagram->from;
      }
      if (datagram->from != *sender) continue;
      const std::span bytes = std::span(buffer).first(datagram->size);
      if (settings_.kind == ForceSensorKind::kOsc) {
        take(decode_force_osc(bytes));
      } else {
        std::string_view line(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        while (line.ends_with('\n') || line.ends_with('\r')) line.remove_suffix(1);
        take(decode_force_line(line));
      }
    }
  }
}

void ForceSensor::serve_serial() {
  std::array<std::uint8_t, 512> buffer{};
  ForceLines lines;
  lines.begin_within_a_line();
  double next_attempt = 0.0;
  while (!ending_.load(std::memory_order_relaxed)) {
    if (!serial_.is_open() && monotonic_time() >= next_attempt) {
      next_attempt = monotonic_time() + kOpenEvery;
      if (serial_.open(port_, settings_.baud).empty()) lines.begin_within_a_line();
    }
    serial_.await_kernel();
    std::size_t got = 0;
    while ((got = serial_.read(buffer)) > 0) {
      lines.feed(std::span(buffer).first(got),
                 [this](std::string_view line) { take(decode_force_line(line)); });
      if (ending_.load(std::memory_order_relaxed)) return;
    }
    std::this_thread::sleep_for(kSerialPause);
  }
}

}  // namespace softfinger
