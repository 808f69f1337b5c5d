// What is set in a Maestro itself, against what its device file says: tried when the port is
// opened.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "../support/maestro_terminal.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/motors/maestro/maestro_bus.hpp"
#include "softfinger/motors/transport_file.hpp"
#include "softfinger/motors/transport_text.hpp"

namespace softfinger {
namespace {

using testing::HasSubstr;

constexpr std::array kTwoServos{
    EmulatedServo{.channel = 1, .initial_setpoint = 1500 * us, .rate = 1.0},
    EmulatedServo{.channel = 4, .initial_setpoint = 1200 * us, .rate = 1.0}};

TransportSettings transport_with(bool crc, double serial_timeout, double rate = 60.0) {
  TransportSettings transport{.kind = "maestro", .rate = rate};
  transport.crc = crc;
  transport.serial_timeout = serial_timeout;
  for (const EmulatedServo& servo : kTwoServos) {
    transport.servos.push_back({.channel = servo.channel, .max_rate = 1.0});
  }
  return transport;
}

bool answers_in_time(MaestroBus& bus) {
  std::array<std::int32_t, 2> positions{};
  for (int i = 0; i < 100; ++i) {
    if (i % 20 == 0) bus.ask();
    if (bus.take_positions(positions)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

TEST(MaestroSettings, WithChecksumsTheBoardMovesAndAnswers) {
  const MaestroTerminal maestro(kTwoServos, {.crc = true});
  MaestroBus bus(transport_with(true, 0.0));
  ASSERT_EQ(bus.open(maestro.port()), "");
  ASSERT_TRUE(bus.write(std::array<std::int32_t, 2>{6400, 5200}));
  EXPECT_TRUE(answers_in_time(bus));
  EXPECT_EQ(maestro.emulator().target(1), 6400);
  EXPECT_EQ(maestro.emulator().target(4), 5200);
  EXPECT_EQ(maestro.emulator().malformed_bytes(), 0U);
  EXPECT_EQ(bus.complaints(0), 0);
}

TEST(MaestroSettings, ABoardWithoutChecksumsIsRefusedWhereTheFileHasThem) {
  const MaestroTerminal maestro(kTwoServos);
  MaestroBus bus(transport_with(true, 0.0));
  EXPECT_THAT(bus.open(maestro.port()), HasSubstr("CRC mode is off"));
  EXPECT_FALSE(bus.is_open());
  EXPECT_EQ(maestro.emulator().targets_set(), 0U);
  // A device under way has to get away from the finger.
  bus.lead_those_left();
  EXPECT_EQ(bus.open(maestro.port()), "");
}

TEST(MaestroSettings, ABoardThatDoesNotAnswerIsRefusedWhereSomethingIsToBeTried) {
  const MaestroTerminal checked(kTwoServos, {.crc = true});
  MaestroBus without(transport_with(false, 0.0));
  EXPECT_EQ(without.open(checked.port()), "") << "a line may have one direction alone";
  EXPECT_FALSE(answers_in_time(without));
  without.close();
  MaestroBus timed(transport_with(false, 0.1));
  EXPECT_THAT(timed.open(checked.port()), HasSubstr("serial timeout"));

  class Mute : public BusEmulator {
    void receive(std::span<const std::uint8_t>) override {}
    std::size_t take_replies(std::span<std::uint8_t>) override { return 0; }
    void advance_to(double) override {}
    [[nodiscard]] double setpoint(std::size_t) const override { return 0.0; }
  } mute;
  const EmulatorTerminal terminal(mute);
  MaestroBus with(transport_with(true, 0.0));
  EXPECT_THAT(with.open(terminal.port()), HasSubstr("answers no question with a checksum"));
}

TEST(MaestroSettings, ATimeoutThatIsOffOrLongerIsRefused) {
  for (const double board : {0.0, 0.3}) {
    const MaestroTerminal maestro(kTwoServos, {.serial_timeout = board});
    MaestroBus bus(transport_with(false, 0.1));
    EXPECT_THAT(bus.open(maestro.port()), HasSubstr("off, or longer than 100 ms")) << board;
    EXPECT_FALSE(bus.is_open());
  }
  for (const bool crc : {false, true}) {
    const MaestroTerminal maestro(kTwoServos, {.crc = crc, .serial_timeout = 0.1});
    MaestroBus same(transport_with(crc, 0.1));
    EXPECT_EQ(same.open(maestro.port()), "");
    EXPECT_TRUE(answers_in_time(same));
    EXPECT_EQ(same.complaints(0), 0) << "what was tried is of the past";
  }
}

// To try it is to let it happen: the board takes its servos home, from wherever they were.
TEST(MaestroSettings, WhereATimeoutIsTriedServosGoHomeNoFasterThanTheyMay) {
  constexpr double kRate = 200 * us;  // of the pulse, in a second
  MaestroEmulator board(kTwoServos,
                        {.serial_timeout = 0.1, .on_error = MaestroBoard::OnError::kGoTo});
  board.receive(encode_set_target(1, 8000));  // 2000 us, and home is 1500
  board.advance_to(0.002);
  const EmulatorTerminal terminal(board);
  TransportSettings transport = transport_with(false, 0.1);
  for (ServoSettings& servo : transport.servos) servo.max_rate = kRate;
  MaestroBus bus(transport);
  const auto began = std::chrono::steady_clock::now();
  ASSERT_EQ(bus.open(terminal.port()), "");
  std::array<std::int32_t, 2> positions{};
  bool known = false;
  for (int i = 0; i < 100 && !known; ++i) {
    if (i % 20 == 0) bus.ask();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    known = bus.take_positions(positions);
  }
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - began;
  ASSERT_TRUE(known);
  EXPECT_EQ(board.target(1), 6000) << "on its way home";
  EXPECT_GE(positions[0] * kQuarterMicrosecond, 2000 * us - 1.05 * kRate * passed.count());
}

// In a tick each servo is sent 4 bytes, asked by 2 and answers 2; the errors take 3 more. A
// command's checksum is one.
TEST(MaestroSettings, ARateThatTheBaudCarriesIsTakenAndNoHigherOne) {
  const auto is_taken = [](bool crc, double rate) {
    TransportSettings transport = transport_with(crc, 0.0, rate);
    transport.baud = 9600;
    try {
      const MaestroBus bus(transport);
      return true;
    } catch (const InputError&) {
      return false;
    }
  };
  for (const auto& [crc, bytes] : {std::pair(false, 2 * 8 + 3), std::pair(true, 2 * 10 + 4)}) {
    const double most = 960.0 / bytes;
    EXPECT_TRUE(is_taken(crc, 0.999 * most)) << crc;
    EXPECT_FALSE(is_taken(crc, 1.001 * most)) << crc;
  }
}

/// A board behind a line of so many bytes a second, whatever the terminal says.
class Trickle {
 public:
  explicit Trickle(double rate) : board_(kTwoServos), slow_(board_, rate), terminal_(slow_) {}
  [[nodiscard]] const std::string& port() const { return terminal_.port(); }

 private:
  class Slow : public BusEmulator {
   public:
    Slow(MaestroEmulator& board, double rate) : board_(board), rate_(rate) {}
    void receive(std::span<const std::uint8_t> bytes) override {
      waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
    }
    std::size_t take_replies(std::span<std::uint8_t> out) override {
      std::size_t taken = 0;
      for (; taken < out.size() && credit_ >= 1.0 && has_reply(); ++taken, --credit_) {
        out[taken] = reply_;
        reply_known_ = false;
      }
      return taken;
    }
    void advance_to(double time) override {
      credit_ = std::min(credit_ + rate_ * (time - time_), 4.0);
      time_ = time;
      for (; credit_ >= 1.0 && !waiting_.empty() && !has_reply(); --credit_) {
        board_.receive(std::span(waiting_).first(1));
        waiting_.erase(waiting_.begin());
      }
      board_.advance_to(time);
    }
    [[nodiscard]] double setpoint(std::size_t servo) const override {
      return board_.setpoint(servo);
    }

   private:
    bool has_reply() {
      if (!reply_known_) reply_known_ = board_.take_replies(std::span(&reply_, 1)) == 1;
      return reply_known_;
    }
    MaestroEmulator& board_;
    double rate_;
    double time_ = 0.0;
    double credit_ = 0.0;
    std::vector<std::uint8_t> waiting_;
    std::uint8_t reply_ = 0;
    bool reply_known_ = false;
  };
  MaestroEmulator board_;
  Slow slow_;
  EmulatorTerminal terminal_;
};

// A bridge, to whom the baud of the file is nothing: its answers tell.
TEST(MaestroSettings, ALineThatIsSlowerThanItsFileSaysIsRefused) {
  const Trickle slow(400.0);
  MaestroBus bus(transport_with(false, 0.0, 50.0));
  const std::string reason = bus.open(slow.port());
  EXPECT_THAT(reason, HasSubstr("for what a tick of 20 ms says; lower rate_Hz"));
  // 19 bytes, on a line that carries 400 a second: somewhat more on a busy machine.
  EXPECT_GE(std::stod(reason.substr(std::string("its line takes ").size())), 40.0) << reason;
  EXPECT_FALSE(bus.is_open());
  MaestroBus patient(transport_with(false, 0.0, 5.0));
  EXPECT_EQ(patient.open(slow.port()), "");
}

TEST(MaestroSettings, AreReadAndWrittenAndRefusedWithTheirKey) {
  const JointLimits limits{.min = JointAngles::Constant(1, -20.0 * deg),
                           .max = JointAngles::Constant(1, 20.0 * deg)};
  const auto read = [&](const std::string& keys) {
    const ConfigFile file("device.toml",
                          "[transport]\nkind = \"maestro\"\n" + keys +
                              "[[transport.servo]]\nchannel = 3\nzero_us = 1500.0\nus_per_deg = "
                              "10.0\nmin_us = 900.0\nmax_us = 2400.0\n");
    return read_transport(file.root().table("transport"), limits);
  };
  const auto refusal = [&](const std::string& keys) -> std::string {
    try {
      (void)read(keys);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  const TransportSettings plain = read("");
  EXPECT_FALSE(plain.crc);
  EXPECT_EQ(plain.serial_timeout, 0.0);
  EXPECT_THAT(transport_text(plain, false), testing::Not(HasSubstr("crc")));
  const TransportSettings both = read("crc = true\nserial_timeout_ms = 250.0\n");
  EXPECT_TRUE(both.crc);
  EXPECT_DOUBLE_EQ(both.serial_timeout, 0.25);
  const std::string text = transport_text(both, false);
  EXPECT_THAT(text, HasSubstr("\ncrc = true\n"));
  EXPECT_THAT(text, HasSubstr("\nserial_timeout_ms = 250\n"));
  EXPECT_THAT(refusal("serial_timeout_ms = 166.0\n"),
              HasSubstr("device.toml:3: transport.serial_timeout_ms: 166 is less than 166.667"));
  EXPECT_EQ(refusal("serial_timeout_ms = 167.0\n"), "");
  EXPECT_THAT(refusal("serial_timeout_ms = 2001.0\n"), HasSubstr("serial_timeout_ms"));
  EXPECT_THAT(refusal("crc = 1\n"), HasSubstr("transport.crc"));
}

}  // namespace
}  // namespace softfinger
