// A Maestro's checksums and its own timeout, with a line that spoils or holds back; in simulated
// time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "lever_line.hpp"
#include "softfinger/motors/maestro/maestro_emulator.hpp"

namespace softfinger {
namespace {

class SpoiltMaestro : public LeverLine {
 protected:
  SpoiltMaestro() : LeverLine({.rate = 60.0, .crc = true}) {
    line_.plug_in(board_);
    line_.wanted = [this](double time) {
      Configuration q = pressing_;
      q[2] += 1.0 * mm * std::sin(9.0 * time);
      return q;
    };
  }
  void note_sent(const SimulatedLine::Bytes& bytes) {
    MaestroDecoder decoder(true);
    for (const std::uint8_t byte : bytes) {
      const auto request = decoder.push(byte);
      if (!request || request->command != MaestroCommand::kSetTarget) continue;
      meant_.insert({request->channel, request->values[0]});
    }
  }

  Board board_ = board_at(*device_, device_->home());
  std::set<std::pair<int, int>> meant_;
};

TEST_F(SpoiltMaestro, NoServoIsSentWhereNobodyMeantToAndTheDeviceRetracts) {
  std::mt19937_64 random(3);
  line_.to_board = [&](SimulatedLine::Bytes& bytes) {
    note_sent(bytes);
    if (line_.time() < 1.0) return;
    for (std::uint8_t& byte : bytes) {
      if (random() % 40 == 0) byte ^= static_cast<std::uint8_t>(1U << (random() % 8));
    }
  };
  for (double time = 0.0; time < 4.0; time += 1.0 / 60.0) {
    line_.at(time, [this] {
      for (std::size_t i = 0; i < 3; ++i) {
        const int channel = device_->settings().transport->servos[i].channel;
        const int target = board_.target(i);
        if (line_.sent().empty()) continue;  // where it began
        EXPECT_TRUE(meant_.contains({channel, target})) << channel << " to " << target;
        ++looks_;
      }
    });
  }
  line_.run(4.0);
  EXPECT_GT(looks_, 600);
  EXPECT_GT(meant_.size(), 100U);
  EXPECT_TRUE(line_.channel().stop.is_stopped());
  EXPECT_EQ(line_.channel().stop.cause(), StopCause::kServo);
}

class SilentMaestro : public LeverLine {
 protected:
  SilentMaestro() : LeverLine({.rate = 60.0, .serial_timeout = 0.2}) { line_.plug_in(board_); }
  Board board_ = board_at(*device_, device_->home());
};

TEST_F(SilentMaestro, GoesHomeByItselfAndNothingGoesOnBeforeARelease) {
  line_.to_board = [this](SimulatedLine::Bytes& bytes) {
    if (line_.time() > 1.0 && line_.time() < 1.5) bytes.clear();
  };
  line_.at(0.99, [this] {
    ++looks_;
    EXPECT_LE(away(pressing_), 0.3 * deg);
  });
  line_.at(1.45, [this] {
    ++looks_;
    EXPECT_LE(away(device_->home()), 0.3 * deg) << "the board's own doing";
  });
  line_.at(3.0, [this] {
    ++looks_;
    EXPECT_TRUE(line_.channel().stop.is_stopped());
    EXPECT_EQ(line_.channel().stop.cause(), StopCause::kServo);
    EXPECT_LE(away(device_->retracted()), 0.3 * deg);
    line_.ask_release(line_.channel().stop.newest());
  });
  line_.at(4.5, [this] {
    ++looks_;
    EXPECT_FALSE(line_.channel().stop.is_stopped());
    EXPECT_LE(away(pressing_), 0.3 * deg);
  });
  line_.run(5.0);
  EXPECT_EQ(looks_, 4);
}

// The bus is silent for a little more than the device file says.
TEST_F(SilentMaestro, ABoardThatIsMorePatientIsNotOpened) {
  for (const double patience : {0.21, 0.25, 0.5}) {
    SimulatedLine line(device_);
    std::vector<EmulatedServo> servos;
    for (const ServoSettings& servo : device_->settings().transport->servos) {
      servos.push_back({.channel = servo.channel, .initial_setpoint = servo.zero, .rate = 1.0});
    }
    auto maestro =
        std::make_unique<MaestroEmulator>(servos, MaestroBoard{.serial_timeout = patience});
    Board board;
    board.commands = [&it = *maestro] { return it.targets_set(); };
    board.target = [&](std::size_t) { return 6000; };
    board.bus = std::move(maestro);
    line.plug_in(board);
    line.wanted = [this](double) { return pressing_; };
    line.at(1.0, [&] {
      ++looks_;
      EXPECT_EQ(line.channel().connected.load(), patience < 0.24) << patience;
    });
    line.run(1.5);
  }
  EXPECT_EQ(looks_, 3);
}

/// Servos that say nothing any more, after the port was gone: nobody waits for their answers.
TEST_F(SpoiltMaestro, OneThatIsMuteAtItsReturnIsLedAllTheSame) {
  line_.wanted = [this](double) { return pressing_; };
  line_.at(1.0, [this] { line_.unplug(); });
  line_.at(1.2, [this] {
    line_.from_board = [](SimulatedLine::Bytes& bytes) { bytes.clear(); };
    line_.plug_in(board_);
  });
  line_.at(6.0, [this] {
    ++looks_;
    EXPECT_TRUE(line_.channel().connected.load());
    EXPECT_LE(away(pressing_), 0.3 * deg);
  });
  line_.at(6.1, [this] { line_.wanted = [this](double) { return device_->home(); }; });
  line_.at(9.0, [this] {
    ++looks_;
    EXPECT_LE(away(device_->home()), 0.3 * deg);
  });
  line_.run(9.5);
  EXPECT_EQ(looks_, 2);
}

// Before there is anything to say the line speaks all the same.
TEST_F(SilentMaestro, IsKeptAwakeWhileNothingIsWanted) {
  line_.wanted = [this](double time) -> std::optional<Configuration> {
    if (time < 2.0) return std::nullopt;
    return pressing_;
  };
  line_.at(1.0, [this] {
    ++looks_;
    EXPECT_EQ(line_.channel().state, DeviceState::kHoming) << "open, and nothing is wanted yet";
  });
  line_.at(4.0, [this] {
    ++looks_;
    EXPECT_FALSE(line_.channel().stop.is_stopped());
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(line_.channel().complaints[i].load(), 0);
    EXPECT_LE(away(pressing_), 0.3 * deg);
  });
  line_.run(5.0);
  EXPECT_EQ(looks_, 2);
}

}  // namespace
}  // namespace softfinger
