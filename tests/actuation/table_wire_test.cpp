// What a bus of servos with a control table says on its wire, frame by frame; in simulated time.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "lever_line.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/motors/dynamixel/dynamixel_protocol.hpp"
#include "softfinger/motors/feetech/feetech_protocol.hpp"
#include "softfinger/motors/servo_bus.hpp"
#include "softfinger/motors/servo_map.hpp"
#include "softfinger/motors/servo_table/frame_reader.hpp"
#include "softfinger/motors/servo_table/servo_table_emulator.hpp"

namespace softfinger {
namespace {

std::unique_ptr<const ServoProtocol> table_protocol(const std::string& kind) {
  if (kind == "dynamixel") return std::make_unique<DynamixelProtocol>();
  return std::make_unique<FeetechProtocol>();
}

struct WireFrame {
  double time;  ///< s
  ServoFrame frame;
  [[nodiscard]] bool is(ServoInstruction instruction) const {
    return frame.code == static_cast<std::uint8_t>(instruction);
  }
};

/// A line that presses, with all that goes to its servos.
class TableWire : public LeverLine {
 protected:
  TableWire(const std::string& kind, double rate)
      : LeverLine({.rate = rate, .kind = kind}), protocol_(table_protocol(kind)) {
    line_.plug_in(board_);
    line_.to_board = [this](SimulatedLine::Bytes& bytes) {
      reader_.push(bytes, [this](const ServoFrame& frame) {
        said_.push_back({line_.time(), frame});
      });
    };
  }
  [[nodiscard]] std::vector<WireFrame> said(ServoInstruction instruction) const {
    std::vector<WireFrame> found;
    std::ranges::copy_if(said_, std::back_inserter(found),
                         [&](const WireFrame& one) { return one.is(instruction); });
    return found;
  }
  /// A number of the parameters, of as many bytes as addresses have, or of so many.
  [[nodiscard]] std::uint32_t number(const ServoFrame& frame, std::size_t at,
                                     std::size_t bytes = 0) const {
    const auto wide = static_cast<std::size_t>(protocol_->table().address_bytes);
    return register_value(frame.used().subspan(at * wide, bytes == 0 ? wide : bytes));
  }

  std::unique_ptr<const ServoProtocol> protocol_;
  Board board_ = board_at(*device_, device_->home());
  FrameReader reader_{*protocol_};
  std::vector<WireFrame> said_;
};

class TableQuestions : public TableWire, public testing::WithParamInterface<const char*> {
 protected:
  TableQuestions() : TableWire(GetParam(), 60.0) {}
};
INSTANTIATE_TEST_SUITE_P(Buses, TableQuestions, testing::Values("dynamixel", "feetech"),
                         [](const auto& kind) { return std::string(kind.param); });

// Every eighth question is for the torque, and halfway between them something else has its turn.
TEST_P(TableQuestions, AreForThePositionButForEveryFourth) {
  line_.run(3.0);
  const ControlTable& table = protocol_->table();
  std::vector<ServoRegister> turns{table.watchdog_question, table.temperature_question};
  for (ServoRegister& turn : turns) {
    if (turn.size == 0) turn = table.present;
  }
  const auto asked = said(ServoInstruction::kSyncRead);
  ASSERT_GT(asked.size(), 150U);
  for (std::size_t k = 1; k <= asked.size(); ++k) {
    ServoRegister expected = table.present;
    if (k % 8 == 0) expected = table.torque_question;
    if (k % 8 == 4) expected = turns[k / 8 % 2];
    const ServoFrame& frame = asked[k - 1].frame;
    ASSERT_EQ(number(frame, 0), expected.address) << k;
    ASSERT_EQ(number(frame, 1), expected.size) << k;
    const auto ids = frame.used().last(3);
    ASSERT_TRUE(ids[0] == 1 && ids[1] == 3 && ids[2] == 5);
  }
}

// A port that is opened anew begins with the same.
TEST_P(TableQuestions, BeginAnewWithThePort) {
  line_.at(1.0, [this] { line_.unplug(); });
  line_.at(1.1, [this] { line_.plug_in(board_); });
  line_.run(3.0);
  const ControlTable& table = protocol_->table();
  const auto pings = said(ServoInstruction::kPing);
  ASSERT_GE(pings.size(), 6U);
  int question = 0;
  for (const WireFrame& one : said(ServoInstruction::kSyncRead)) {
    if (one.time < pings.back().time) continue;
    ++question;
    const ServoRegister expected = question % 8 == 0 ? table.torque_question : table.present;
    if (question % 8 == 4) continue;
    EXPECT_EQ(number(one.frame, 0), expected.address) << question;
  }
  EXPECT_GT(question, 60);
}

// So that no servo jumps to what it was told in another life.
TEST_P(TableQuestions, EachServoIsToldToStayWhereItIsBeforeItGetsTorque) {
  line_.run(0.5);
  const ControlTable& table = protocol_->table();
  const auto& servos = device_->settings().transport->servos;
  std::map<int, std::uint32_t> goals;
  int torques = 0;
  for (const WireFrame& one : said(ServoInstruction::kWrite)) {
    const std::uint32_t address = number(one.frame, 0);
    const std::uint32_t value =
        register_value(one.frame.used().subspan(static_cast<std::size_t>(table.address_bytes)));
    if (address == table.goal.address) goals[one.frame.id] = value;
    if (address != table.torque.address || value == 0) continue;
    const auto servo = std::ranges::find(servos, int{one.frame.id}, &ServoSettings::channel);
    ASSERT_NE(servo, servos.end());
    const auto joint = joints_at(device_->home())[servo - servos.begin()];
    ASSERT_TRUE(goals.contains(one.frame.id));
    EXPECT_NEAR(protocol_->to_position(goals[one.frame.id]), ServoMap(*servo).setpoint(joint), 1.0);
    ++torques;
  }
  EXPECT_EQ(torques, 3);
}

// One goal a tick to all of them, which is what the line says it sent.
TEST_P(TableQuestions, EachIsAskedAndToldOnceATick) {
  line_.run(3.0);
  const auto asked = said(ServoInstruction::kSyncRead);
  const ControlTable& table = protocol_->table();
  std::size_t goals = 0;
  for (const WireFrame& told : said(ServoInstruction::kSyncWrite)) {
    if (table.watchdog.size == 0) {
      EXPECT_EQ(number(told.frame, 0), table.goal.address) << "there is nothing else to tell";
    }
    if (number(told.frame, 0) != table.goal.address) continue;
    ++goals;
    EXPECT_EQ(number(told.frame, 1), table.goal.size);
    EXPECT_EQ(told.frame.size,
              2U * static_cast<std::size_t>(table.address_bytes) + 3U * (1U + table.goal.size));
  }
  EXPECT_EQ(goals, line_.sent().size());
  EXPECT_EQ(goals, line_.channel().commands_sent.load());
  EXPECT_NEAR(static_cast<double>(asked.size()), static_cast<double>(goals), 1.0);
  for (std::size_t k = 1; k < asked.size(); ++k) {
    EXPECT_GE(asked[k].time - asked[k - 1].time, 0.49 * line_.period());
    EXPECT_LE(asked[k].time - asked[k - 1].time, 1.51 * line_.period());
  }
}

/// Rate (Hz), and the watchdog of 20 ms a unit that it leads to.
struct WatchdogAtRate {
  double rate;
  std::uint32_t watchdog;
};
class TableWatchdog : public TableWire, public testing::WithParamInterface<WatchdogAtRate> {
 protected:
  TableWatchdog() : TableWire("dynamixel", GetParam().rate) {}
};
// A second, or five ticks, and what the register holds.
INSTANTIATE_TEST_SUITE_P(Rates, TableWatchdog,
                         testing::Values(WatchdogAtRate{60.0, 50}, WatchdogAtRate{4.0, 63},
                                         WatchdogAtRate{2.5, 100}, WatchdogAtRate{1.0, 127}),
                         [](const auto& at) {
                           return std::to_string(static_cast<int>(10.0 * at.param.rate));
                         });

TEST_P(TableWatchdog, IsOnFromTheFirstGoalToTheEnd) {
  line_.run(8.0);
  std::vector<std::uint32_t> told;
  std::vector<double> times;
  double first_goal = -1.0;
  const ControlTable& table = protocol_->table();
  for (const WireFrame& one : said(ServoInstruction::kSyncWrite)) {
    const std::uint32_t address = number(one.frame, 0);
    if (address == table.goal.address && first_goal < 0.0) first_goal = one.time;
    if (address != table.watchdog.address) continue;
    told.push_back(register_value(one.frame.used().last(1)));
    times.push_back(one.time);
    EXPECT_EQ(one.frame.size, 4U + 3U * 2U) << "to all three";
  }
  ASSERT_EQ(told, (std::vector<std::uint32_t>{GetParam().watchdog, 0}));
  EXPECT_EQ(times.front(), first_goal);
  EXPECT_GT(times.back(), 8.0);
}

class SearchedTable : public TableWire {
 protected:
  SearchedTable() : TableWire("dynamixel", 60.0) {}
};

// Those that are lost may have ears; and from the next goal on it watches again.
TEST_F(SearchedTable, WatchesWhileItIsLedAndNotWhileALostServoIsLookedFor) {
  constexpr double kSearch = 5.0;
  line_.at(2.0, [this] { dynamic_cast<ServoTableEmulator&>(*board_.bus).cut_off(1); });
  line_.at(kSearch, [this] { line_.ask_release(line_.channel().stop.newest()); });
  line_.run(8.0);
  const ControlTable& table = protocol_->table();
  std::vector<std::uint32_t> told;
  std::vector<double> times;
  double next_goal = -1.0;
  for (const WireFrame& one : said(ServoInstruction::kSyncWrite)) {
    const std::uint32_t address = number(one.frame, 0);
    const bool found = !times.empty() && times.back() >= kSearch;
    if (address == table.goal.address && found && next_goal < 0.0) next_goal = one.time;
    if (address != table.watchdog.address) continue;
    told.push_back(register_value(one.frame.used().last(1)));
    times.push_back(one.time);
  }
  ASSERT_EQ(told, (std::vector<std::uint32_t>{50, 0, 50, 0}));
  const auto pings = said(ServoInstruction::kPing);
  const auto search =
      std::ranges::find_if(pings, [](const WireFrame& one) { return one.time >= kSearch; });
  ASSERT_NE(search, pings.end());
  EXPECT_GE(times[1], kSearch);
  EXPECT_LE(times[1], search->time);
  EXPECT_GT(times[2], pings.back().time);
  EXPECT_EQ(times[2], next_goal);
}

class TablePings : public TableWire, public testing::WithParamInterface<const char*> {
 protected:
  TablePings() : TableWire(GetParam(), 60.0) {}
  /// Pings of each id, with their times, within the first second and a half or so.
  [[nodiscard]] std::map<int, std::vector<double>> pings(double until) const {
    std::map<int, std::vector<double>> of_id;
    for (const WireFrame& one : said(ServoInstruction::kPing)) {
      if (one.time < until) of_id[one.frame.id].push_back(one.time);
    }
    return of_id;
  }
  static void expect_patience(const std::vector<double>& times) {
    ASSERT_EQ(times.size(), 5U);
    // 100 ms for the answer, and as long for one that is late.
    for (std::size_t k = 1; k < times.size(); ++k) {
      EXPECT_NEAR(times[k] - times[k - 1], 0.2, 5e-4);
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Buses, TablePings, testing::Values("dynamixel", "feetech"),
                         [](const auto& kind) { return std::string(kind.param); });

TEST_P(TablePings, AreFiveUnlessNobodyHasAnsweredSoFar) {
  line_.from_board = [](SimulatedLine::Bytes& bytes) { bytes.clear(); };
  line_.run(0.1);
  auto of_id = pings(1.95);
  expect_patience(of_id[1]);
  expect_patience(of_id[3]);
  EXPECT_EQ(of_id[5].size(), 1U) << "no more patience for the rest";
  EXPECT_NEAR(of_id[5].front() - of_id[1].front(), 1.8 + 8e-4, 2e-3);
}

// As of one without power among others.
TEST_P(TablePings, AreFiveForEachThatIsSilentAmongOthers) {
  std::uint8_t pinged = 0;
  line_.to_board = [&, log = line_.to_board](SimulatedLine::Bytes& bytes) {
    log(bytes);
    if (!said_.empty()) pinged = said_.back().frame.id;
  };
  line_.from_board = [&](SimulatedLine::Bytes& bytes) {
    if (pinged != 1) bytes.clear();
  };
  line_.run(0.1);
  auto of_id = pings(2.2);
  EXPECT_EQ(of_id[1].size(), 1U);
  expect_patience(of_id[3]);
  expect_patience(of_id[5]);
}

// A tick's goals to all, the question to all and the longest answer of each, 10 bits a byte, and
// half a millisecond before each answers.
TEST(TableSpeed, ARateThatTheBaudCarriesIsTakenAndNoHigherOne) {
  for (const bool dynamixel : {true, false}) {
    for (const int servos : {1, 3, 12}) {
      TransportSettings transport;
      transport.kind = dynamixel ? "dynamixel" : "feetech";
      transport.baud = 57600;
      for (int id = 1; id <= servos; ++id) {
        transport.servos.push_back({.channel = id, .min = 1000.0, .max = 3000.0, .step = 1.0});
      }
      const int bytes = dynamixel ? (14 + 5 * servos) + (14 + servos) + servos * (11 + 7)
                                  : (8 + 3 * servos) + (8 + servos) + servos * (6 + 2);
      const double most = 1.0 / (10.0 * bytes / transport.baud + 500e-6 * servos);
      transport.rate = 0.999 * most;
      EXPECT_NE(make_servo_bus(transport), nullptr) << transport.kind << servos;
      transport.rate = 1.001 * most;
      EXPECT_THROW((void)make_servo_bus(transport), InputError) << transport.kind << servos;
    }
  }
}

}  // namespace
}  // namespace softfinger
