#include <array>
#include <cmath>
#include <memory>

#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"
#include "softfinger/motors/feetech/feetech_protocol.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"

// A bus full of noise: frames that are found must be written as they were read, and no servo may
// leave its turn. The first byte says whose frames, and how the rest comes in pieces.
extern "C" int fuzz_servo_frame(const std::uint8_t* data, std::size_t size) {
  using namespace softfinger;
  if (size == 0) return 0;
  const bool dynamixel = (data[0] & 1) != 0;
  const std::size_t piece = 1 + data[0] / 2;
  const auto protocol = [&]() -> std::unique_ptr<const ServoProtocol> {
    if (dynamixel) return std::make_unique<DynamixelProtocol>();
    return std::make_unique<FeetechProtocol>();
  };
  const std::span<const std::uint8_t> line(data + 1, size - 1);
  const auto reading = protocol();
  FrameReader reader(*reading);
  reader.push(line, [&](const ServoFrame& frame) {
    std::array<std::uint8_t, ServoProtocol::kMostBytes> bytes{};
    const std::size_t length = reading->encode(frame, bytes);
    const auto written = std::span<const std::uint8_t>(bytes).first(length);
    if (reading->frame_length(written) != static_cast<int>(length)) __builtin_trap();
    const ServoFrame again = reading->decode(written);
    if (again.id != frame.id || again.code != frame.code || again.parameters != frame.parameters ||
        again.size != frame.size) {
      __builtin_trap();
    }
    if (const auto status = reading->status(frame)) (void)register_value(status->data);
  });

  const std::array<EmulatedServo, 2> servos{
      EmulatedServo{.channel = 1, .initial_setpoint = 2048.0, .rate = 4000.0, .step = 1.0},
      EmulatedServo{.channel = 2, .initial_setpoint = 2048.0, .rate = 4000.0, .step = 1.0}};
  ServoTableEmulator emulator(protocol(), servos);
  std::array<std::uint8_t, 128> replies{};
  double time = 0.0;
  for (std::size_t i = 0; i < line.size(); i += piece) {
    emulator.receive(line.subspan(i, std::min(piece, line.size() - i)));
    (void)emulator.take_replies(replies);
    emulator.advance_to(time += 5e-3);
  }
  for (std::size_t i = 0; i < servos.size(); ++i) {
    if (!std::isfinite(emulator.setpoint(i))) __builtin_trap();
  }
  return 0;
}
