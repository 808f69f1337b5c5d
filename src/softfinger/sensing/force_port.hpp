#pragma once

#include <string>

#include "softfinger/sensing/force_sensor_settings.hpp"
#include "softfinger/wire/endpoint.hpp"

namespace softfinger {

/// Whether the sensor sends over a network.
[[nodiscard]] constexpr bool is_network(ForceSensorKind kind) {
  return kind == ForceSensorKind::kUdp || kind == ForceSensorKind::kOsc;
}

/// Where to listen: "9100" is a port of this machine alone (loopback), "ADDRESS:PORT" one that
/// others may reach; an emulated sensor's is any free one. Returns an empty text, or in few words
/// why it is none.
[[nodiscard]] std::string force_endpoint(const ForceSensorSettings& settings, Endpoint& endpoint);

/// Empty where `port` is one for this kind of sensor; nothing is opened.
[[nodiscard]] std::string why_no_force_port(const ForceSensorSettings& settings);

}  // namespace softfinger
