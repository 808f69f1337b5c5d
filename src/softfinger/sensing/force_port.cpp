#include "softfinger/sensing/force_port.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace softfinger {
namespace {

bool is_number(const std::string& text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::string force_endpoint(const ForceSensorSettings& settings, Endpoint& endpoint) {
  endpoint = {kLoopback, 0};
  if (settings.is_emulated()) return {};
  const std::string& port = settings.port;
  const std::string why =
      find_endpoint(is_number(port) ? address_text(kLoopback) + ':' + port : port, endpoint);
  return why.empty() ? why
                     : fmt::format(
                           "'{}': expected a port such as 9100, \"ADDRESS:PORT\" or "
                           "\"emulator\"; {}",
                           port.substr(0, 60), why);
}

std::string why_no_force_port(const ForceSensorSettings& settings) {
  if (settings.is_emulated()) return {};
  switch (settings.kind) {
    case ForceSensorKind::kEmulator:
      return "an emulator has none; leave it out, or name another kind";
    case ForceSensorKind::kSerial:
      if (settings.port.empty() || is_number(settings.port)) {
        return "expected the name of a serial port such as \"/dev/ttyUSB0\", or \"emulator\"";
      }
      return {};
    case ForceSensorKind::kUdp:
    case ForceSensorKind::kOsc:
      break;
  }
  Endpoint endpoint;
  return force_endpoint(settings, endpoint);
}

}  // namespace softfinger
