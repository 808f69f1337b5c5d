// What goes wrong while servos on a bus are being made ready, at any moment of it; in simulated
// time.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <tuple>

#include "lever_line.hpp"
#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"
#include "softfinger/motors/feetech/feetech_protocol.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"

namespace softfinger {
namespace {

enum class SetupFault { kMute, kDeaf, kNoise, kRefusals, kOneRefusal, kUnplugged, kReset };

class SetupFaults : public testing::TestWithParam<std::tuple<const char*, SetupFault>> {
 protected:
  static constexpr double kLasts = 0.7;  ///< s
  /// Where the answers to the longest setup end, and what is between two that are looked at.
  static constexpr int kAnswers = 80;
  static constexpr int kApart = 11;

  /// An error of a servo in the place of its answer.
  static void refuse(SimulatedLine::Bytes& answer) {
    std::unique_ptr<ServoProtocol> protocol = std::make_unique<FeetechProtocol>();
    if (std::string(std::get<0>(GetParam())) == "dynamixel") {
      protocol = std::make_unique<DynamixelProtocol>();
    }
    if (protocol->frame_length(answer) <= 0) return;
    const auto length = static_cast<std::size_t>(protocol->frame_length(answer));
    const ServoFrame frame = protocol->decode(std::span(answer).first(length));
    answer.resize(ServoProtocol::kMostBytes);
    answer.resize(protocol->encode(protocol->status_frame(frame.id, 4, {}), answer));
  }
};

constexpr std::array kFaultNames{"Mute",       "Deaf",      "Noise", "Refusals",
                                 "OneRefusal", "Unplugged", "Reset"};

INSTANTIATE_TEST_SUITE_P(
    Buses, SetupFaults,
    testing::Combine(testing::Values("dynamixel", "feetech"),
                     testing::Values(SetupFault::kMute, SetupFault::kDeaf, SetupFault::kNoise,
                                     SetupFault::kRefusals, SetupFault::kOneRefusal,
                                     SetupFault::kUnplugged, SetupFault::kReset)),
    [](const auto& name) {
      return std::string(std::get<0>(name.param)) +
             kFaultNames.at(static_cast<std::size_t>(std::get<1>(name.param)));
    });

TEST_P(SetupFaults, EndInADeviceThatIsLedAsIfThereHadBeenNone) {
  const auto device = lever_platform({.rate = 60.0, .kind = std::get<0>(GetParam())});
  const SetupFault fault = std::get<1>(GetParam());
  Configuration pressing(3);
  pressing << 4.0 * deg, 0.0, 3.0 * mm;
  JointAngles goal;
  ASSERT_TRUE(device->inverse_kinematics(pressing, goal));
  JointAngles retracted;
  ASSERT_TRUE(device->inverse_kinematics(device->retracted(), retracted));
  int began = 0;
  int looks = 0;
  for (int first = 0; first < kAnswers; first += kApart) {
    SCOPED_TRACE(first);
    SimulatedLine line(device);
    Board board = board_at(*device, device->home());
    line.wanted = [&](double) { return pressing; };
    // Half of them as a line that takes the place of another, which leads those that are left.
    if (first % 2 == 1) line.was_sent_before(device->home());
    int answers = 0;
    double begins = -1.0;
    const auto under_way = [&] { return begins >= 0.0 && line.time() < begins + kLasts; };
    line.to_board = [&](SimulatedLine::Bytes& bytes) {
      if (under_way() && fault == SetupFault::kDeaf) bytes.clear();
    };
    line.from_board = [&](SimulatedLine::Bytes& bytes) {
      if (bytes.empty()) return;
      if (answers++ == first) {
        begins = line.time();
        ++began;
        if (fault == SetupFault::kReset) board.reset();
        if (fault == SetupFault::kOneRefusal) refuse(bytes);
        if (fault == SetupFault::kUnplugged) {
          line.at(line.time(), [&] { line.unplug(); });
          line.at(line.time() + kLasts, [&] { line.plug_in(board); });
        }
      }
      if (!under_way()) return;
      if (fault == SetupFault::kMute) bytes.clear();
      if (fault == SetupFault::kNoise) bytes[bytes.size() / 2] ^= 0x10;
      if (fault == SetupFault::kRefusals) refuse(bytes);
    };
    line.plug_in(board);
    // What was lost for good while it lasted is looked for when somebody releases the device.
    for (const double time : {5.0, 8.0}) {
      line.at(time, [&] { line.ask_release(line.channel().stop.newest()); });
    }
    line.at(11.0, [&] {
      ++looks;
      EXPECT_TRUE(line.channel().connected);
      EXPECT_FALSE(line.channel().stop.is_stopped());
      EXPECT_LE((line.standing() - goal).cwiseAbs().maxCoeff(), 0.3 * deg);
    });
    line.run(11.2);
    EXPECT_LE((line.standing() - retracted).cwiseAbs().maxCoeff(), 0.3 * deg);
  }
  EXPECT_EQ(looks, (kAnswers + kApart - 1) / kApart);
  EXPECT_EQ(began, looks);
}

/// Frames that are none of what was asked for, around each answer: of an id that nobody has, with
/// an error, of another size, and no answer at all.
class StrangersOnTheLine : public LeverLine, public testing::WithParamInterface<const char*> {
 protected:
  StrangersOnTheLine() : LeverLine({.rate = 60.0, .kind = GetParam()}) { line_.plug_in(board_); }

  void add(SimulatedLine::Bytes& bytes, const ServoFrame& frame) const {
    std::array<std::uint8_t, ServoProtocol::kMostBytes> encoded;
    const std::size_t size = protocol().encode(frame, encoded);
    bytes.insert(bytes.end(), encoded.begin(), encoded.begin() + static_cast<std::ptrdiff_t>(size));
  }
  [[nodiscard]] const ServoProtocol& protocol() const {
    static const DynamixelProtocol kDynamixel;
    static const FeetechProtocol kFeetech;
    if (std::string(GetParam()) == "dynamixel") return kDynamixel;
    return kFeetech;
  }

  Board board_ = board_at(*device_, device_->home());
};
INSTANTIATE_TEST_SUITE_P(Buses, StrangersOnTheLine, testing::Values("dynamixel", "feetech"),
                         [](const auto& name) { return std::string(name.param); });

TEST_P(StrangersOnTheLine, AreNotTakenForServos) {
  const std::array<std::uint8_t, 7> far_away{0xFF, 0x0F};
  int strange = 0;
  line_.from_board = [&](SimulatedLine::Bytes& bytes) {
    if (bytes.empty()) return;
    SimulatedLine::Bytes around;
    for (const std::size_t size : {0U, 1U, 2U, 3U, 4U, 7U}) {
      add(around, protocol().status_frame(77, 0, std::span(far_away).first(size)));
    }
    // Of a servo that is asked, but in sizes that no question has.
    const auto servo =
        static_cast<std::uint8_t>(device_->settings().transport->servos.front().channel);
    for (const std::size_t size : {5U, 6U}) {
      add(around, protocol().status_frame(servo, 0, std::span(far_away).first(size)));
    }
    if (std::string(GetParam()) == "dynamixel") {
      // Nor is one that refused what it was asked, or somebody else's question.
      for (const std::size_t size : {1U, 2U, 3U, 4U, 7U}) {
        add(around, protocol().status_frame(servo, 5, std::span(far_away).first(size)));
      }
      add(around, read_request(protocol(), servo, protocol().table().present));
    }
    ++strange;
    // While they are made ready a refusal of their own counts, but nobody else's.
    SimulatedLine::Bytes of_others;
    for (const std::size_t size : {0U, 1U, 2U, 4U}) {
      add(of_others, protocol().status_frame(77, 5, std::span(far_away).first(size)));
    }
    add(of_others, protocol().status_frame(servo, 0, std::span(far_away).first(5)));
    if (line_.time() <= 1.0) bytes.insert(bytes.begin(), of_others.begin(), of_others.end());
    if (line_.time() > 1.0) bytes.insert(bytes.begin(), around.begin(), around.end());
    if (line_.time() > 2.0) bytes.insert(bytes.end(), around.begin(), around.end());
  };
  line_.at(4.0, [this] {
    ++looks_;
    EXPECT_LE(away(pressing_), 0.3 * deg);
    EXPECT_FALSE(line_.channel().stop.is_stopped());
    EXPECT_EQ(line_.channel().times_lost, 0U);
    const auto reported = line_.reported();
    ASSERT_TRUE(reported);
    EXPECT_LE((*reported - line_.standing()).cwiseAbs().maxCoeff(), 0.5 * deg);
  });
  line_.run(4.2);
  EXPECT_EQ(looks_, 1);
  EXPECT_GT(strange, 100);
  expect_no_jump();
}

}  // namespace
}  // namespace softfinger
