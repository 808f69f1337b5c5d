#include <array>

#include "softfinger/motors/weart/weart_emulator.hpp"

// Whatever a client says, the force stays from 0 to 1, and what is understood can be said again.
extern "C" int fuzz_weart(const std::uint8_t* data, std::size_t size) {
  using namespace softfinger;
  WeartReader reader;
  for (std::size_t i = 0; i < size; ++i) {
    const auto request = reader.push(data[i]);
    if (!request || request->kind != WeartRequest::Kind::kForce) continue;
    std::array<char, 128> text{};
    const std::size_t length = encode_weart_force(request->force, request->address, text);
    WeartReader again;
    std::optional<WeartRequest> same;
    for (std::size_t k = 0; k < length; ++k) same = again.push(static_cast<std::uint8_t>(text[k]));
    if (!same || same->address != request->address) __builtin_trap();
  }
  TransportSettings transport;
  transport.kind = "weart";
  transport.servos.push_back({.max = 1.0, .step = 1e-6, .address = "RIGHT:INDEX"});
  WeartEmulator emulator(transport, {.initial_setpoint = 0.0, .rate = 20.0, .step = 1e-6});
  std::array<std::uint8_t, 64> replies{};
  for (std::size_t i = 0; i < size; ++i) {
    emulator.receive({data + i, 1});
    if (i % 64 == 0) (void)emulator.take_replies(replies);
  }
  emulator.advance_to(0.5);
  const double force = emulator.setpoint(0);
  if (!(force >= -1e-9 && force <= 1.0 + 1e-9)) __builtin_trap();
  return 0;
}
