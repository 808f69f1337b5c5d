#include "softfinger/motors/maestro/maestro_emulator.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "softfinger/base/units.hpp"
#include "softfinger/motors/servo_map.hpp"

namespace softfinger {
namespace {

const std::array<EmulatedServo, 2> kServos{
    EmulatedServo{.channel = 1, .initial_setpoint = 1500 * us, .rate = 4000 * us},
    EmulatedServo{.channel = 4, .initial_setpoint = 1200 * us, .rate = 4000 * us}};

std::vector<int> replies(MaestroEmulator& emulator) {
  std::array<std::uint8_t, 16> bytes{};
  const std::size_t size = emulator.take_replies(bytes);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)};
}

void send(MaestroEmulator& emulator, const std::vector<int>& bytes) {
  for (const int byte : bytes) {
    const auto one = static_cast<std::uint8_t>(byte);
    emulator.receive(std::span(&one, 1));
  }
}

TEST(MaestroEmulator, ServosGoToTheirTargetsAtLimitedRate) {
  MaestroEmulator emulator(kServos);
  emulator.receive(encode_set_target(1, 8000));  // 2000 us
  double last = emulator.servo_pulse(1);
  EXPECT_NEAR(last, 1500 * us, 1e-12);
  for (int k = 1; k <= 400; ++k) {
    emulator.advance_to(k * 1e-3);
    const double position = emulator.servo_pulse(1);
    EXPECT_LE(std::abs(position - last), 4000 * us * 1e-3 + 1e-12);
    EXPECT_LE(position, 2000 * us + 1e-9);  // no overshoot
    last = position;
    EXPECT_TRUE(k > 100 || position < 1910 * us) << k;
  }
  EXPECT_NEAR(last, 2000 * us, 0.5 * us);
  EXPECT_NEAR(emulator.servo_pulse(4), 1200 * us, 1e-9);
}

TEST(MaestroEmulator, OnlyTimeMovesIt) {
  MaestroEmulator once(kServos);
  MaestroEmulator often(kServos);
  once.receive(encode_set_target(1, 7000));
  often.receive(encode_set_target(1, 7000));
  for (int k = 1; k <= 37; ++k) often.advance_to(k / 370.0);
  once.advance_to(0.1);
  EXPECT_EQ(once.servo_pulse(1), often.servo_pulse(1));  // bit for bit
  once.advance_to(0.05);
  EXPECT_EQ(once.servo_pulse(1), often.servo_pulse(1));
}

TEST(MaestroEmulator, AnswersQuestions) {
  MaestroEmulator emulator(kServos);
  send(emulator, {0x90, 1});
  EXPECT_EQ(replies(emulator), (std::vector<int>{0x70, 0x17}));
  send(emulator, {0x93});
  EXPECT_EQ(replies(emulator), (std::vector<int>{0}));
  send(emulator, {0xA1});
  EXPECT_EQ(replies(emulator), (std::vector<int>{0, 0}));
  send(emulator, {0x84, 1, 0x84, 1, 0x70, 0x2E, 0xA1, 0xA1});
  EXPECT_EQ(replies(emulator), (std::vector<int>{kSerialProtocolError, 0, 0, 0}));
  EXPECT_EQ(emulator.malformed_bytes(), 2u);
  send(emulator, {0x9F, 2, 4, 0, 0x20, 0, 0x30});
  EXPECT_EQ(emulator.target(4), 0x20 << 7);
  EXPECT_EQ(emulator.target(5), 0x30 << 7);
  send(emulator, {0xA2});
  EXPECT_EQ(emulator.target(4), 4800);
}

TEST(MaestroEmulator, SpeedLimitRampsThePulses) {
  MaestroEmulator emulator(kServos);
  emulator.receive(encode_set_speed(1, 40));  // 10 us / 10 ms: 1000 us/s
  emulator.receive(encode_set_target(1, 6400));
  emulator.advance_to(0.05);
  send(emulator, {0x93, 0x90, 1});
  const auto halfway = replies(emulator);
  ASSERT_EQ(halfway.size(), 3u);
  EXPECT_EQ(halfway[0], 1);
  EXPECT_NEAR(halfway[1] + 256 * halfway[2], 6200, 1);
  emulator.advance_to(0.11);
  send(emulator, {0x93, 0x90, 1});
  EXPECT_EQ(replies(emulator), (std::vector<int>{0, 0x00, 0x19}));
}

TEST(MaestroEmulator, AccelerationLimitArrivesWithoutOvershoot) {
  MaestroEmulator emulator(kServos);
  emulator.receive(encode_set_acceleration(1, 10));
  emulator.receive(encode_set_target(1, 8000));
  int last = 6000;
  int fastest = 0;
  for (int k = 1; k <= 3000; ++k) {
    emulator.advance_to(k * 1e-3);
    send(emulator, {0x90, 1});
    const auto answer = replies(emulator);
    const int position = answer[0] + 256 * answer[1];
    EXPECT_GE(position, last);
    EXPECT_LE(position, 8000);
    fastest = std::max(fastest, position - last);
    last = position;
  }
  EXPECT_EQ(last, 8000);
  EXPECT_LT(fastest, 10);
}

TEST(MaestroEmulator, SilenceIsAnErrorOnceAndAnyCommandEndsIt) {
  for (const auto on_error : {MaestroBoard::OnError::kIgnore, MaestroBoard::OnError::kOff,
                              MaestroBoard::OnError::kGoTo}) {
    MaestroEmulator emulator(kServos, {.serial_timeout = 0.3, .on_error = on_error});
    emulator.receive(encode_set_target(4, 7000));
    emulator.advance_to(0.29);
    send(emulator, {0xA1});
    EXPECT_EQ(replies(emulator), (std::vector<int>{0, 0}));
    emulator.advance_to(0.58);
    EXPECT_EQ(emulator.target(4), 7000);
    emulator.advance_to(0.6);
    const int home[]{7000, 0, 4800};
    EXPECT_EQ(emulator.target(4), home[static_cast<std::size_t>(on_error)]);
    send(emulator, {0xA1, 0xA1});
    EXPECT_EQ(replies(emulator), (std::vector<int>{kSerialTimeout, 0, 0, 0}));
    emulator.advance_to(10.0);
    send(emulator, {0xA1});
    EXPECT_EQ(replies(emulator), (std::vector<int>{kSerialTimeout, 0}));
  }
}

TEST(MaestroEmulator, WrongChecksumsAreErrors) {
  MaestroEmulator emulator(kServos, {.crc = true, .on_error = MaestroBoard::OnError::kGoTo});
  send(emulator, {0x84, 4, 0x70, 0x2E, maestro_crc(encode_set_target(4, 6000))});
  EXPECT_EQ(emulator.target(4), 6000);
  const int sum = maestro_crc(std::array<std::uint8_t, 1>{0xA1});
  send(emulator, {0xA1, sum ^ 1, 0xA1, sum});
  EXPECT_EQ(replies(emulator), (std::vector<int>{kSerialCrcError, 0}));
  EXPECT_EQ(emulator.target(4), 4800) << "home";
}

TEST(MaestroEmulator, WithoutPulsesAServoStaysWhereItIs) {
  MaestroEmulator emulator(kServos);
  emulator.receive(encode_set_target(1, 8000));
  emulator.advance_to(0.05);
  emulator.receive(encode_set_target(1, 0));
  emulator.advance_to(0.051);
  const double here = emulator.servo_pulse(1);
  emulator.advance_to(0.5);
  EXPECT_EQ(emulator.servo_pulse(1), here);
}

}  // namespace
}  // namespace softfinger
