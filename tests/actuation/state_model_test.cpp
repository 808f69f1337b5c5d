// Every state that a device can come into, by a model of all that matters of it: the real state
// machine and the real latch, a device that moves one level a tick, and whatever people, loop,
// tracker, port and guard may do, in every order.
#include <gtest/gtest.h>

#include <algorithm>
#include <compare>
#include <map>
#include <vector>

#include "softfinger/actuation/device_state.hpp"
#include "softfinger/actuation/stop_latch.hpp"

namespace softfinger {
namespace {

constexpr double kModelTick = 0.1;                          // s
constexpr int kStalled = 3;                                 // ticks without a command
constexpr int kRetracted = 0, kAway = 1, kPressing = 2;     // levels of the device
constexpr int kManyTicks = 5;                               // more than any time but one counts to
constexpr int kEnough = kPressing + kStalled + kManyTicks;  // ticks for anything to be over

enum class Command { kNone, kLetGo, kPress };
enum class Person { kNone, kStops, kReleases };
enum class Fault { kNone, kPortGone, kPortBack, kGuardDies };

struct Input {
  Command command = Command::kNone;
  bool tracked = true;
  Person person = Person::kNone;
  Fault fault = Fault::kNone;
  bool ending = false;
};

struct Model {
  DeviceStateMachine machine;
  int time = 0;  // ticks, of the machine
  int level = kRetracted;
  int wanted = kRetracted;
  int silent = 0;          // ticks
  bool commanded = false;  // ever
  bool stopped = false;
  bool port = true;
  bool ending = false;
  // How long the machine has seen what it counts: with it they are all that it remembers.
  int lost_for = 0, retracted_for = 0, ending_for = 0;

  using Key = std::vector<int>;
  [[nodiscard]] Key key() const {
    return {static_cast<int>(machine.state()),
            level,
            wanted,
            std::min(silent, kManyTicks),
            commanded,
            stopped,
            port,
            ending,
            std::min(lost_for, kManyTicks),
            std::min(retracted_for, kManyTicks),
            std::min(ending_for, kManyTicks)};
  }
  [[nodiscard]] bool ended() const { return machine.state() == DeviceState::kStopped; }
};

/// As ServoLine::follow() and tick() do it.
Model next(Model m, const Input& input) {
  m.ending = m.ending || input.ending;
  const bool fresh = input.command != Command::kNone;
  m.silent = fresh ? 0 : m.silent + 1;
  m.commanded = m.commanded || fresh;
  if (fresh) m.wanted = input.command == Command::kPress ? kPressing : kAway;

  StopLatch latch;
  if (m.stopped || input.fault == Fault::kGuardDies) latch.stop(StopCause::kPerson);
  if (input.person == Person::kStops) latch.stop(StopCause::kPerson);
  if (input.person == Person::kReleases) latch.ask_release(latch.newest());

  const bool reopened = input.fault == Fault::kPortBack && !m.port;
  if (input.fault == Fault::kPortGone) m.port = false;
  if (input.fault == Fault::kPortBack) m.port = true;
  if (!m.port || input.fault == Fault::kGuardDies) {  // nobody leads the device
    latch.answer_release(ReleaseRefusal::kPortClosed);
    m.stopped = latch.is_stopped();
    return m;
  }
  if (reopened) {
    m.machine = DeviceStateMachine();
    m.time = m.lost_for = m.retracted_for = m.ending_for = 0;
  }
  if (!m.commanded && !latch.is_stopped()) return m;  // nothing to say yet

  const bool stalled = m.silent >= kStalled;
  if (latch.release_is_asked()) {
    latch.answer_release(stalled                      ? ReleaseRefusal::kNoCommands
                         : m.retracted_for < kStalled ? ReleaseRefusal::kRetracting
                                                      : ReleaseRefusal::kNone);
  }
  m.stopped = latch.is_stopped();
  const auto goal_in = [&](DeviceState state) {
    if (state == DeviceState::kRetracting) return kRetracted;
    return state == DeviceState::kHolding ? m.level : m.wanted;
  };
  const bool arrived = m.level == goal_in(m.machine.state());
  const DeviceState state = m.machine.advance({.time = kModelTick * ++m.time,
                                               .tracked = input.tracked,
                                               .touching = m.level == kPressing,
                                               .ending = m.ending,
                                               .emergency = m.stopped,
                                               .stalled = stalled && !m.ending,
                                               .arrived = arrived});
  if (state == DeviceState::kStopped) return m;
  const int goal = goal_in(state);
  m.level += goal > m.level ? 1 : goal < m.level ? -1 : 0;
  m.lost_for = input.tracked ? 0 : m.lost_for + 1;
  m.ending_for = m.ending ? m.ending_for + 1 : 0;
  m.retracted_for =
      state == DeviceState::kRetracting && m.level == kRetracted ? m.retracted_for + 1 : 0;
  return m;
}

const std::vector<Input>& every_input() {
  static const std::vector<Input> kInputs = [] {
    std::vector<Input> inputs;
    for (const Command command : {Command::kNone, Command::kLetGo, Command::kPress}) {
      for (const bool tracked : {true, false}) {
        for (const Person person : {Person::kNone, Person::kStops, Person::kReleases}) {
          for (const Fault fault :
               {Fault::kNone, Fault::kPortGone, Fault::kPortBack, Fault::kGuardDies}) {
            for (const bool ending : {false, true}) {
              inputs.push_back({command, tracked, person, fault, ending});
            }
          }
        }
      }
    }
    return inputs;
  }();
  return kInputs;
}

const std::map<Model::Key, Model>& every_state() {
  static const std::map<Model::Key, Model> kStates = [] {
    std::map<Model::Key, Model> found;
    std::vector<Model> open{Model{}};
    found.emplace(open.front().key(), open.front());
    while (!open.empty()) {
      const Model model = open.back();
      open.pop_back();
      if (model.ended()) continue;
      for (const Input& input : every_input()) {
        const Model after = next(model, input);
        if (found.emplace(after.key(), after).second) open.push_back(after);
      }
    }
    return found;
  }();
  return kStates;
}

/// Nobody says anything more, and the port is there.
Model after_silence(Model model) {
  model = next(model, {.fault = Fault::kPortBack});
  for (int k = 0; k < kEnough; ++k) model = next(model, {});
  return model;
}

TEST(StateModel, HasManyStatesAndAllThatADeviceCanBeIn) {
  EXPECT_GT(every_state().size(), 1000U);
  std::map<DeviceState, int> seen;
  int pressing_and_stopped = 0;
  for (const auto& [key, model] : every_state()) {
    ++seen[model.machine.state()];
    if (model.level == kPressing && model.stopped) ++pressing_and_stopped;
  }
  for (const DeviceState state :
       {DeviceState::kHoming, DeviceState::kReady, DeviceState::kRendering, DeviceState::kHolding,
        DeviceState::kRetracting, DeviceState::kStopped}) {
    EXPECT_GT(seen[state], 0) << state_name(state);
  }
  EXPECT_GT(pressing_and_stopped, 0);
}

TEST(StateModel, FromEveryStateSilenceLeadsToTheRetractedPose) {
  for (const auto& [key, model] : every_state()) {
    const Model after = after_silence(model);
    ASSERT_EQ(after.level, kRetracted) << testing::PrintToString(key);
    ASSERT_EQ(next(after, {}).level, kRetracted) << testing::PrintToString(key);
  }
}

TEST(StateModel, WhatIsStoppedNeverComesNearerBeforeItIsReleased) {
  for (const auto& [key, model] : every_state()) {
    if (!model.stopped) continue;
    for (const Input& input : every_input()) {
      const Model after = next(model, input);
      ASSERT_TRUE(!after.stopped || after.level <= model.level) << testing::PrintToString(key);
    }
  }
}

TEST(StateModel, OnlyAPersonReleasesAndOnlyWhatIsRetracted) {
  int releases = 0;
  for (const auto& [key, model] : every_state()) {
    if (!model.stopped) continue;
    for (const Input& input : every_input()) {
      if (next(model, input).stopped) continue;
      ++releases;
      ASSERT_EQ(input.person, Person::kReleases) << testing::PrintToString(key);
      ASSERT_EQ(input.fault == Fault::kGuardDies, false) << testing::PrintToString(key);
      ASSERT_EQ(model.level, kRetracted) << testing::PrintToString(key);
      ASSERT_NE(input.command == Command::kNone && model.silent >= kStalled, true);
    }
  }
  EXPECT_GT(releases, 0);
}

TEST(StateModel, AnEndThatBeganEndsRetracted) {
  for (const auto& [key, model] : every_state()) {
    if (!model.ending || !model.port) continue;
    Model after = model;
    for (int k = 0; k < kEnough && !after.ended(); ++k) {
      after = next(after, {.command = Command::kPress});
    }
    ASSERT_TRUE(after.ended()) << testing::PrintToString(key);
    ASSERT_EQ(after.level, kRetracted) << testing::PrintToString(key);
  }
}

}  // namespace
}  // namespace softfinger
