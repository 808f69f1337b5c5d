#include <algorithm>
#include <array>
#include <cmath>

#include "softfinger/motors/maestro/maestro_emulator.hpp"

// A line full of noise must neither stop the emulator nor move a servo further than its pulses say.
extern "C" int fuzz_maestro(const std::uint8_t* data, std::size_t size) {
  using namespace softfinger;
  constexpr std::array<EmulatedServo, 3> kServos{
      EmulatedServo{.channel = 0}, EmulatedServo{.channel = 1}, EmulatedServo{.channel = 23}};
  MaestroEmulator emulator(kServos);
  std::array<std::uint8_t, 64> replies{};
  double time = 0.0;
  // In pieces, as a line delivers them: the first byte of each says how long it is.
  for (std::size_t i = 0; i < size;) {
    const std::size_t length = std::min<std::size_t>(size - i - 1, data[i] % 16);
    emulator.receive({data + i + 1, length});
    i += length + 1;
    emulator.advance_to(time += 4e-3);
    (void)emulator.take_replies(replies);
  }
  for (const EmulatedServo& servo : kServos) {
    const double pulse = emulator.servo_pulse(servo.channel);
    if (!std::isfinite(pulse) || pulse < 0.0 || pulse > kMaestroMaxValue * 0.25e-6)
      __builtin_trap();
  }
  return 0;
}
