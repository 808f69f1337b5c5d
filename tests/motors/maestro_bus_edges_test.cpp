#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/motors/maestro/maestro_bus.hpp"
#include "softfinger/motors/maestro/maestro_protocol.hpp"

namespace softfinger {
namespace {

using MaestroBytes = std::vector<std::uint8_t>;

/// The far end of a line, byte by byte.
class BareTerminal {
 public:
  BareTerminal() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    EXPECT_EQ(::grantpt(master_), 0);
    EXPECT_EQ(::unlockpt(master_), 0);
    std::array<char, 128> name{};
    EXPECT_EQ(::ptsname_r(master_, name.data(), name.size()), 0);
    port_ = name.data();
  }
  ~BareTerminal() { ::close(master_); }
  BareTerminal(const BareTerminal&) = delete;
  BareTerminal& operator=(const BareTerminal&) = delete;

  [[nodiscard]] const std::string& port() const { return port_; }
  void say(const MaestroBytes& bytes) const {
    ASSERT_EQ(::write(master_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  /// All that came, once it is so much or nothing more comes.
  [[nodiscard]] MaestroBytes heard(std::size_t wanted) const {
    MaestroBytes bytes;
    while (true) {
      pollfd event{.fd = master_, .events = POLLIN, .revents = 0};
      if (::poll(&event, 1, bytes.size() < wanted ? 2000 : 0) != 1) return bytes;
      std::array<std::uint8_t, 256> part;
      const ssize_t got = ::read(master_, part.data(), part.size());
      if (got <= 0) return bytes;
      bytes.insert(bytes.end(), part.begin(), part.begin() + got);
    }
  }

 private:
  int master_;
  std::string port_;
};

ServoSettings servo_on(int channel, double max_rate = 0.0, double max_acceleration = 0.0) {
  return {.channel = channel, .max_rate = max_rate, .max_acceleration = max_acceleration};
}

TransportSettings maestro_with(std::vector<ServoSettings> servos) {
  TransportSettings transport;
  transport.kind = "maestro";
  transport.servos = std::move(servos);
  return transport;
}

/// What a Maestro answers for these positions, and for its errors.
MaestroBytes answer_of(std::initializer_list<int> positions) {
  MaestroBytes bytes;
  for (const int position : positions) {
    bytes.push_back(static_cast<std::uint8_t>(position & 0xFF));
    bytes.push_back(static_cast<std::uint8_t>(position >> 8));
  }
  return bytes;
}

/// Waits until the answer has come through the line.
bool takes(MaestroBus& bus, std::span<std::int32_t> positions, int looks = 1000) {
  for (int i = 0; i < looks; ++i) {  // a busy machine brings it late
    if (bus.take_positions(positions)) return true;
    ::usleep(5000);
  }
  return false;
}

bool takes_nothing(MaestroBus& bus, std::span<std::int32_t> positions) {
  return !takes(bus, positions, 20);
}

TEST(MaestroBusEdges, HasTheChannelsOfAMaestroAndNoOthers) {
  EXPECT_NO_THROW(MaestroBus(maestro_with({servo_on(0), servo_on(23)})));
  for (const int channel : {-1, 24}) {
    try {
      const MaestroBus bus(maestro_with({servo_on(channel)}));
      FAIL() << channel;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(),
                  testing::HasSubstr(std::to_string(channel) + " is none of a Maestro's 0 to 23"));
    }
  }
}

TEST(MaestroBusEdges, SaysEachTargetToItsChannelAndAsksEach) {
  const BareTerminal terminal;
  MaestroBus bus(maestro_with({servo_on(3), servo_on(7)}));
  ASSERT_EQ(bus.open(terminal.port()), "");
  EXPECT_EQ(terminal.heard(1), MaestroBytes{0xA1}) << "no limits, so none are sent";
  ASSERT_TRUE(bus.write(std::array<std::int32_t, 2>{6000, 5001}));
  EXPECT_EQ(terminal.heard(8), (MaestroBytes{0x84, 3, 0x70, 0x2E, 0x84, 7, 0x09, 0x27}));
  ASSERT_TRUE(bus.ask());
  EXPECT_EQ(terminal.heard(5), (MaestroBytes{0x90, 3, 0x90, 7, 0xA1}));
  bus.drain();
  EXPECT_EQ(terminal.heard(0), MaestroBytes())
      << "a board without a timeout need not be kept awake";
}

TEST(MaestroBusEdges, TheLastOfSeveralAnswersCounts) {
  const BareTerminal terminal;
  MaestroBus bus(maestro_with({servo_on(3), servo_on(7)}));
  ASSERT_EQ(bus.open(terminal.port()), "");
  EXPECT_FALSE(bus.answers());
  std::array<std::int32_t, 2> positions{};
  EXPECT_FALSE(bus.take_positions(positions));
  EXPECT_FALSE(bus.answers());
  terminal.say(answer_of({6000, 5001, 0}));
  ASSERT_TRUE(takes(bus, positions));
  EXPECT_TRUE(bus.answers());
  EXPECT_EQ(positions, (std::array<std::int32_t, 2>{6000, 5001}));
  terminal.say(answer_of({4000, 4001, 0, 7000, 7001, 0}));
  ASSERT_TRUE(takes(bus, positions));
  EXPECT_EQ(positions, (std::array<std::int32_t, 2>{7000, 7001}));
}

TEST(MaestroBusEdges, WhatCameBeforeAQuestionIsNoAnswer) {
  const BareTerminal terminal;
  MaestroBus bus(maestro_with({servo_on(3), servo_on(7)}));
  const int held = ::open(terminal.port().c_str(), O_RDWR | O_NOCTTY);
  terminal.say({0x70, 0x17, 0x00, 0x00});
  EXPECT_EQ(bus.open(terminal.port()), "") << "it has not answered, as a line of one direction";
  ::close(held);
}

TEST(MaestroBusEdges, HalfAnAnswerIsNone) {
  const BareTerminal terminal;
  MaestroBus bus(maestro_with({servo_on(3), servo_on(7)}));
  ASSERT_EQ(bus.open(terminal.port()), "");
  std::array<std::int32_t, 2> positions{};
  terminal.say({0x70, 0x17});
  EXPECT_TRUE(takes_nothing(bus, positions));
  EXPECT_FALSE(bus.answers());
}

// Rate and acceleration in units of the board, rounded up: 0 would be no limit.
TEST(MaestroBusEdges, SendsLimitsWhenItOpensAndAgainWherePulsesHadStopped) {
  const BareTerminal terminal;
  // A speed of 1 is 0.25 us in 10 ms, an acceleration of 1 that in 80 ms.
  MaestroBus bus(maestro_with({servo_on(2, 100.2 * 25e-6, 10.5 * 0.25e-6 / (10e-3 * 80e-3)),
                               servo_on(5, 1e-9), servo_on(6, 1.0, 1.0), servo_on(8)}));
  const MaestroBytes limits{0xA1, 0x87, 2,    101,  0,    0x89, 2,    11,  0,  //
                            0x87, 5,    1,    0,    0x89, 5,    0,    0,       //
                            0x87, 6,    0x7F, 0x7F, 0x89, 6,    0x7F, 0x01};
  ASSERT_EQ(bus.open(terminal.port()), "");
  EXPECT_EQ(terminal.heard(limits.size()), limits);

  const std::array<std::int32_t, 4> targets{6000, 6000, 6000, 6000};
  std::array<std::int32_t, 4> positions{};
  const auto sent = [&](std::size_t wanted) {
    EXPECT_TRUE(bus.write(targets));
    return terminal.heard(wanted).size();
  };
  EXPECT_EQ(sent(16), 16U);
  // Without pulses from the start: they have not stopped.
  terminal.say(answer_of({6000, 0, 6000, 6000, 0}));
  EXPECT_TRUE(takes_nothing(bus, positions));
  EXPECT_EQ(sent(16), 16U);
  terminal.say(answer_of({6000, 6000, 6000, 6000, 0}));
  EXPECT_TRUE(takes(bus, positions));
  EXPECT_EQ(sent(16), 16U);
  for (int k = 0; k < 2; ++k) {  // told twice, sent once
    terminal.say(answer_of({6000, 6000, 6000, 0, 0}));
    EXPECT_TRUE(takes_nothing(bus, positions));
  }
  EXPECT_EQ(sent(15 + limits.size()), 15U + limits.size()) << "limits go first";
  EXPECT_EQ(sent(16), 16U) << "once";
  terminal.say(answer_of({6000, 6000, 6000, 0, 0}));
  EXPECT_TRUE(takes_nothing(bus, positions));
  EXPECT_EQ(sent(16), 16U) << "and no more for pulses that have not come back";
}

/// Time that passes where somebody waits for it.
struct SleptClock final : LineClock {
  std::function<void()> sleeping;
  TimePoint time{};

  [[nodiscard]] TimePoint now() noexcept override { return time; }
  void sleep_until(TimePoint due) noexcept override {
    time = due;
    if (sleeping) sleeping();
  }
  bool wait(std::span<pollfd> /*events*/, TimePoint due) noexcept override {
    time = due;
    return false;
  }
};

// Without its limits a servo would go as fast as it can.
TEST(MaestroBusEdges, APortThatVanishesBeforeTheLimitsAreSentIsNotOpen) {
  auto terminal = std::make_unique<BareTerminal>();
  SleptClock clock;
  MaestroBus bus(maestro_with({servo_on(3, 1e-9)}), clock);
  bus.lead_those_left();
  clock.sleeping = [&] { terminal.reset(); };  // while it waits for its first answer
  EXPECT_THAT(bus.open(terminal->port()), testing::HasSubstr("limits the servos' speed"));
  EXPECT_FALSE(bus.is_open());
}

// Bits of the error register: those of the line, and those of a script on the board.
TEST(MaestroBusEdges, ComplainsOfASecondErrorAndOfSilenceAtOnce) {
  const BareTerminal terminal;
  MaestroBus bus(maestro_with({servo_on(3)}));
  ASSERT_EQ(bus.open(terminal.port()), "");
  std::array<std::int32_t, 1> positions{};
  const auto complaint_after = [&](int errors) {
    terminal.say(answer_of({6000, errors}));
    EXPECT_TRUE(takes(bus, positions));
    return static_cast<int>(bus.complaints(0));
  };
  const auto forget = [&] {
    for (int k = 0; k < 8; ++k) complaint_after(0);
  };
  for (const int error : {kSerialSignalError, kSerialOverrunError, kSerialBufferFull,
                          kSerialCrcError, kSerialProtocolError}) {
    EXPECT_EQ(complaint_after(error), 0) << error;
    for (int k = 0; k < 6; ++k) EXPECT_EQ(complaint_after(0), 0);
    EXPECT_EQ(complaint_after(error), kBadLine) << error;
    for (int k = 0; k < 7; ++k) EXPECT_EQ(complaint_after(0), kBadLine) << k;
    EXPECT_EQ(complaint_after(0), 0) << error;
    EXPECT_EQ(complaint_after(error), 0) << "that before is forgotten";
    forget();
  }
  EXPECT_EQ(complaint_after(kSerialTimeout), kBadLine);
  forget();
  for (const int script : {1 << 6, 1 << 7, 1 << 8}) {
    EXPECT_EQ(complaint_after(script), kDefect) << script;
    forget();
    EXPECT_EQ(bus.complaints(0), 0);
  }
  // Of several late answers each counts.
  terminal.say(answer_of({6000, kSerialCrcError, 6000, 0}));
  EXPECT_TRUE(takes(bus, positions));
  EXPECT_EQ(complaint_after(kSerialCrcError), kBadLine);
}

// What was heard of one board says nothing of the next.
TEST(MaestroBusEdges, OpenedAgainItKnowsNothingOfWhatWasBefore) {
  const BareTerminal first;
  MaestroBus bus(maestro_with({servo_on(3, 1e-9)}));
  ASSERT_EQ(bus.open(first.port()), "");
  std::array<std::int32_t, 1> positions{};
  for (int k = 0; k < 2; ++k) {
    first.say(answer_of({6000, kSerialCrcError}));
    ASSERT_TRUE(takes(bus, positions));
  }
  ASSERT_EQ(bus.complaints(0), kBadLine);
  first.say(answer_of({0, 0}));
  EXPECT_TRUE(takes_nothing(bus, positions));  // its limits are due now
  bus.close();

  const BareTerminal second;
  ASSERT_EQ(bus.open(second.port()), "");
  EXPECT_FALSE(bus.answers());
  EXPECT_EQ(bus.complaints(0), 0);
  const std::size_t opening = 1 + 8;
  EXPECT_EQ(second.heard(opening).size(), opening);
  EXPECT_TRUE(bus.write(std::array<std::int32_t, 1>{6000}));
  EXPECT_EQ(second.heard(4).size(), 4U) << "its limits were sent as it was opened";
  second.say(answer_of({0, 0}));
  EXPECT_TRUE(takes_nothing(bus, positions));
  EXPECT_TRUE(bus.write(std::array<std::int32_t, 1>{6000}));
  EXPECT_EQ(second.heard(4).size(), 4U) << "no pulses have stopped";
  second.say(answer_of({6000, kSerialCrcError}));
  ASSERT_TRUE(takes(bus, positions));
  EXPECT_EQ(bus.complaints(0), 0) << "the first error";
}

/// How many requests are in bytes.
int requests_in(MaestroDecoder& decoder, const MaestroBytes& bytes) {
  int requests = 0;
  for (const std::uint8_t byte : bytes) requests += decoder.push(byte).has_value() ? 1 : 0;
  return requests;
}

// Data alone repeats no command.
TEST(MaestroDecoderEdges, WhatFollowsAWholeCommandIsNoneOfIt) {
  MaestroDecoder decoder;
  EXPECT_EQ(requests_in(decoder, {0x84, 3, 0x70, 0x2E}), 1);
  EXPECT_EQ(requests_in(decoder, {3, 0x70, 0x2E, 3, 0x70, 0x2E}), 0);
  EXPECT_EQ(decoder.malformed_bytes(), 6U);
}

TEST(MaestroDecoderEdges, ACommandThatIsNoneIsCountedAtOnce) {
  MaestroDecoder decoder;
  EXPECT_EQ(requests_in(decoder, {0x80}), 0);
  EXPECT_EQ(decoder.malformed_bytes(), 1U);
  EXPECT_EQ(requests_in(decoder, {1, 2}), 0);
  EXPECT_EQ(decoder.malformed_bytes(), 3U);
  EXPECT_EQ(requests_in(decoder, {0x84, 3, 0x70, 0x2E}), 1);
}

}  // namespace
}  // namespace softfinger
