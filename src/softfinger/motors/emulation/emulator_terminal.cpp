#include "softfinger/motors/emulation/emulator_terminal.hpp"

#include <array>
#include <chrono>

namespace softfinger {
namespace {

/// How long the thread sleeps when no byte comes: two servo steps.
constexpr int kIdle_ms = 2;

}  // namespace

EmulatorTerminal::EmulatorTerminal(BusEmulator& emulator) : emulator_(emulator) {
  thread_ = std::thread([this] { serve(); });
}

EmulatorTerminal::~EmulatorTerminal() { vanish(); }

void EmulatorTerminal::vanish() {
  if (!thread_.joinable()) return;
  stop_ = true;
  thread_.join();
  terminal_.vanish();
}

void EmulatorTerminal::serve() {
  const auto start = std::chrono::steady_clock::now();
  std::array<std::uint8_t, 512> buffer{};
  while (!stop_.load(std::memory_order_relaxed)) {
    terminal_.wait(kIdle_ms);
    emulator_.advance_to(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    const std::size_t got = terminal_.read(buffer);
    if (got > 0) emulator_.receive(std::span(buffer).first(got));
    terminal_.write(std::span(buffer).first(emulator_.take_replies(buffer)));
  }
}

}  // namespace softfinger
