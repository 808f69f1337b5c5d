// One chain in its roles: its ticks taken here, handed over to another thread, or taken again from
// what was recorded, give the same bits.
#include "softfinger/loop/finger_chain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "../support/folders.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/device/device_file.hpp"
#include "softfinger/loop/tick_handover.hpp"

namespace softfinger {
namespace {

constexpr std::int64_t kSteps = 400;
constexpr double kRate = 1000.0;  // Hz

/// Into a plane, tilting, and out again; tracking is lost for a while.
TrackedInput press(std::int64_t step) {
  const double time = static_cast<double>(step) / kRate;
  const double depth = std::min(time, 0.4 - time) / 0.2 * 2.5 * mm;
  TrackedPose tracked;
  tracked.time = time;
  tracked.X_WFt = {exp_rotation({10.0 * deg * time, 6.0 * deg, 0.0}), {0.0, 0.0, 7.0 * mm - depth}};
  tracked.valid = step < 250 || step > 300;
  return TrackedInput(tracked);
}

class FingerChainOf : public testing::Test {
 protected:
  FingerChainOf() : objects_(1) { objects_[0].shape = HalfSpace{}; }

  [[nodiscard]] FingerChainOptions options(bool with_device = true) const {
    const std::filesystem::path project = source_folder();
    static const auto model = FingerModel::load(project / "fingers/index.toml");
    static const auto device = load_device(project / "devices/thimble-3rrs.toml");
    FingerChainOptions options{
        .finger = 3, .model = model, .objects = objects_, .simulation_rate = kRate};
    if (with_device) options.device = device;
    options.device_loop.actuator.port = "emulator";
    options.device_loop.actuator.simulated_time = true;
    return options;
  }

  /// What is recorded, in order.
  struct Rows {
    std::vector<StepRecord> steps;
    std::vector<TickRecord> ticks;
  };

  static Rows by_hand(FingerChain& chain) {
    Rows rows;
    rows.steps.push_back(chain.start(press(0)));
    for (std::int64_t step = 1; step <= kSteps; ++step) {
      chain.step(step, press(step));
      if (chain.tick_is_due()) {
        rows.ticks.push_back(chain.tick(chain.tick_input(std::chrono::steady_clock::now())));
      }
      rows.steps.push_back(chain.seal());
    }
    return rows;
  }

  static void expect_same(const Rows& a, const Rows& b) {
    ASSERT_EQ(a.steps.size(), b.steps.size());
    ASSERT_EQ(a.ticks.size(), b.ticks.size());
    for (std::size_t i = 0; i < a.steps.size(); ++i) {
      const char* difference = first_difference(a.steps[i], b.steps[i]);
      ASSERT_EQ(difference, nullptr) << difference << " of step " << i;
    }
    for (std::size_t i = 0; i < a.ticks.size(); ++i) {
      const char* difference = first_difference(a.ticks[i], b.ticks[i]);
      ASSERT_EQ(difference, nullptr) << difference << " of tick " << i;
    }
  }

  std::vector<VirtualObject> objects_;
};

TEST_F(FingerChainOf, TicksOnTheDeviceClockAndNamesThem) {
  FingerChain chain(options());
  const Rows rows = by_hand(chain);
  const double rate = device_rate(chain.device().device());
  ASSERT_EQ(rows.ticks.size(), static_cast<std::size_t>(kSteps / kRate * rate) + 1);
  std::int64_t known = -1;
  auto tick = rows.ticks.begin();
  double most = 0.0;
  for (const StepRecord& step : rows.steps) {
    EXPECT_EQ(step.finger, 3);
    most = std::max(most, step.normal_force);
    if (tick != rows.ticks.end() && tick->step == step.step) {
      EXPECT_EQ(tick->time, step.time);
      EXPECT_EQ(tick->tracked, step.tracked.valid);
      EXPECT_EQ(tick->finger, 3);
      known = (tick++)->tick;
    }
    EXPECT_EQ(step.tick, known);
  }
  EXPECT_EQ(tick, rows.ticks.end());
  EXPECT_GT(most, 0.2) << "N, or nothing is rendered";
  EXPECT_TRUE(std::ranges::any_of(rows.ticks, [](const TickRecord& row) { return !row.tracked; }));
}

TEST_F(FingerChainOf, WithoutADeviceNeverTicks) {
  FingerChain chain(options(false));
  EXPECT_FALSE(chain.has_device());
  const Rows rows = by_hand(chain);
  EXPECT_TRUE(rows.ticks.empty());
  EXPECT_EQ(rows.steps.back().tick, -1);
  chain.finish();  // there is nothing to retract
}

TEST_F(FingerChainOf, RepeatsItsBits) {
  FingerChain one(options());
  FingerChain other(options());
  expect_same(by_hand(one), by_hand(other));
}

// On a thread of its own the device ticks some steps later; steps learn of it later still.
TEST_F(FingerChainOf, HandedOverTicksAreThoseTakenHere) {
  FingerChain here(options());
  const Rows rows = by_hand(here);
  FingerChain chain(options());
  TickHandover handover(*options().model);
  Mailbox<std::pair<std::int64_t, std::uint64_t>> feedback;
  Rows live;
  std::thread device([&] {
    while (const HandedTick* handed = handover.take()) {
      live.ticks.push_back(chain.tick(handed->input, handed->finger()));
      feedback.draft() = {live.ticks.back().tick, live.ticks.back().hash};
      feedback.publish();
    }
  });
  const auto told = [&](std::int64_t tick) {
    while (!feedback.refresh() || feedback.latest().first < tick) std::this_thread::yield();
  };
  live.steps.push_back(chain.start(press(0)));
  std::int64_t ticks = 0;
  for (std::int64_t step = 1; step <= kSteps; ++step) {
    chain.step(step, press(step));
    if (chain.tick_is_due()) {
      handover.hand_over(chain.tick_input(std::chrono::steady_clock::now()),
                         chain.virtual_finger());
      EXPECT_EQ(handover.last().step, step);
      told(ticks++);
      chain.know(feedback.latest().first, feedback.latest().second);
    }
    live.steps.push_back(chain.seal());
  }
  handover.end();
  device.join();
  expect_same(rows, live);
}

TEST_F(FingerChainOf, AReplayTakesTicksFromRowsWhateverItsClockSays) {
  FingerChain original(options());
  // As in a live run: a tick of every seventh step, known three steps later.
  Rows rows;
  rows.steps.push_back(original.start(press(0)));
  TickRecord tick = original.device().record();
  for (std::int64_t step = 1; step <= kSteps; ++step) {
    original.step(step, press(step));
    if (step % 7 == 0) {
      tick = original.device().record();
      TickInput input = original.tick_input(std::chrono::steady_clock::now());
      input.emergency = step > 350;
      tick = original.tick(input, original.virtual_finger());
      rows.ticks.push_back(tick);
    }
    if (step % 7 == 3 && tick.tick >= 0) original.know(tick.tick, tick.hash);
    rows.steps.push_back(original.seal());
  }
  FingerChainOptions again = options();
  again.device_loop.replay = true;
  FingerChain replayed(again);
  Rows replay;
  replay.steps.push_back(replayed.start(rows.steps.front().tracked));
  auto next = rows.ticks.begin();
  for (std::size_t i = 1; i < rows.steps.size(); ++i) {
    const StepRecord& row = rows.steps[i];
    replayed.step(row.step, row.tracked);
    if (next != rows.ticks.end() && next->step == row.step) {
      TickInput input = replayed.tick_input(std::chrono::steady_clock::now());
      input.emergency = (next++)->emergency;
      replay.ticks.push_back(replayed.tick(input));
    }
    if (row.tick >= 0) {
      replayed.know(row.tick, replay.ticks[static_cast<std::size_t>(row.tick)].hash);
    } else {
      replayed.know(-1, 0);
    }
    replay.steps.push_back(replayed.seal());
  }
  expect_same(rows, replay);
  EXPECT_TRUE(rows.ticks.back().emergency);
}

TEST_F(FingerChainOf, FinishRetractsTheDevice) {
  FingerChain chain(options());
  by_hand(chain);
  const std::uint64_t sent = chain.device().actuator().commands_sent();
  chain.finish();
  const Actuator& actuator = chain.device().actuator();
  EXPECT_TRUE(actuator.finished());
  EXPECT_GT(actuator.commands_sent(), sent);
  EXPECT_TRUE(
      actuator.last_command().configuration.isApprox(chain.device().device().retracted(), 1e-6));
}

TEST(TickHandover, GivesTheNewestAloneAndNothingAfterItsEnd) {
  const auto model =
      FingerModel::load(std::filesystem::path(source_folder()) / "fingers/index.toml");
  TickHandover handover(*model);
  ContactSet contact;
  EXPECT_EQ(handover.last().step, 0);
  for (const std::int64_t step : {5, 6}) {
    contact.contact_count = static_cast<int>(step);
    handover.hand_over({.step = step}, {contact, {}, Pose()});
  }
  const HandedTick* handed = handover.take();
  ASSERT_NE(handed, nullptr);
  EXPECT_EQ(handed->input.step, 6);
  EXPECT_EQ(handed->finger().contact.contact_count, 6);
  handover.hand_over({.step = 7}, {contact, {}, Pose()});
  handover.end();
  EXPECT_EQ(handover.take(), nullptr);
}

}  // namespace
}  // namespace softfinger
