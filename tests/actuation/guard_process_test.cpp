#include "softfinger/actuation/guard_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sched.h>
#include <signal.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

#include "../support/folders.hpp"
#include "guarded_thimble.hpp"
#include "softfinger/actuation/actuator.hpp"
#include "softfinger/actuation/travel_ceiling.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

using ::testing::HasSubstr;

TEST(GuardSetup, SaysAllAndKeepsEveryBit) {
  const auto device = load_device(kThimble);
  GuardSetup setup{.device_file = kThimble,
                   .device_text = device->settings().text,
                   .line = {.port = "/dev/no\"port\n", .rate = 1.0 / 3.0, .unpaced = true},
                   .wait_for_device = true};
  const std::vector<Vector3> skin = {{0.1, -0.2, 1.0 / 7.0}, {1e-300, 0.0, -1e-3}};
  setup.line.ceiling = std::make_shared<const TravelCeiling>(
      device, skin, std::vector<TravelCeiling::GridAxis>{{0, -0.4, 0.4, 2}},
      std::vector<double>{1.0 / 3.0, 2e-3});
  const GuardedDevice told = read_guard_setup(to_text(setup));
  EXPECT_EQ(told.setup.device_file, setup.device_file);
  EXPECT_EQ(told.setup.line.port, setup.line.port);
  EXPECT_EQ(told.setup.line.rate, setup.line.rate);
  EXPECT_TRUE(told.setup.line.unpaced);
  EXPECT_TRUE(told.setup.wait_for_device);
  EXPECT_EQ(told.setup.line.ceiling->rest_skin(), skin);
  EXPECT_EQ(told.setup.line.ceiling->depths(), setup.line.ceiling->depths());
  EXPECT_EQ(told.setup.line.ceiling->grid().front().max, 0.4);
  EXPECT_EQ(told.device->joint_count(), device->joint_count());
}

TEST(GuardSetup, TheDeviceIsTheLoopsWhateverBecameOfItsFile) {
  const auto device = load_device(kThimble);
  const GuardedDevice told = read_guard_setup(to_text({.device_file = "/gone/since.toml",
                                                       .device_text = device->settings().text,
                                                       .line = {.port = "none"}}));
  EXPECT_EQ(told.device->settings().as_read, device->settings().as_read);
}

TEST(GuardSetup, WhatIsNoneIsRefused) {
  for (const char* text : {"", "{}", "[1,2]", R"({"device_file":1})"}) {
    EXPECT_THROW((void)read_guard_setup(text), InputError) << text;
  }
}

TEST(GuardSetup, AnotherVersionsIsRefusedInOneLine) {
  const auto device = load_device(kThimble);
  std::string text = to_text(
      {.device_file = kThimble, .device_text = device->settings().text, .line = {.port = "none"}});
  const std::size_t at = text.find("\"version\":\"") + 11;
  ASSERT_LT(at, text.size());
  text[at] = '9';
  try {
    (void)read_guard_setup(text);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("two versions"));
  }
}

TEST_F(GuardedThimble, FollowsAndRetractsAtTheEnd) {
  Actuator actuator(device, options());
  EXPECT_TRUE(actuator.connected());
  EXPECT_TRUE(follow(actuator, wanted, [&] { return away_from(wanted) < kNear; }));
  EXPECT_EQ(actuator.state(), DeviceState::kRendering);
  JointAngles read;
  EXPECT_TRUE(actuator.read_servo_joints(read));
  actuator.finish();
  EXPECT_LT(away_from(device->retracted()), kNear);
  EXPECT_EQ(actuator.state(), DeviceState::kStopped);
  EXPECT_EQ(actuator.take_event(), std::nullopt);
}

TEST_F(GuardedThimble, EndsWithItsProcessAndNoLater) {
  GuardProcess guard(guard_program(), device->home(), setup());
  const std::ptrdiff_t descriptors = open_descriptors();
  ASSERT_EQ(guard.start(false), "");
  ASSERT_TRUE(soon([&] {
    guard.submit(wanted, DeviceState::kRendering);
    return away_from(wanted) < kNear;
  }));
  const int process = guard.process();
  std::thread end([&] { guard.finish(); });
  ASSERT_TRUE(soon([&] { return guard.channel().state == DeviceState::kStopped; }));
  const auto stopped = std::chrono::steady_clock::now();
  end.join();
  EXPECT_LT(std::chrono::steady_clock::now() - stopped, std::chrono::milliseconds(700))
      << "a second where it hangs";
  EXPECT_NE(::kill(process, 0), 0) << "it has ended, and was waited for";
  EXPECT_EQ(open_descriptors(), descriptors);
}

TEST_F(GuardedThimble, RetractsWhileTheLoopIsSilent) {
  Actuator actuator(device, options());
  ASSERT_TRUE(follow(actuator, wanted, [&] { return away_from(wanted) < kNear; }));
  EXPECT_TRUE(soon([&] { return away_from(device->retracted()) < kNear; }));
  EXPECT_EQ(actuator.take_event(), ActuatorEvent::kLoopStalled);
  EXPECT_TRUE(follow(actuator, wanted, [&] { return away_from(wanted) < kNear; }));
}

TEST_F(GuardedThimble, SaysWhyAPortCannotBeOpened) {
  ActuatorOptions absent = options();
  absent.port = "/dev/softfinger-no-such-port";
  try {
    const Actuator actuator(device, absent);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("there is no such port"));
  }
  absent.guard_program = "/no/such/program";
  EXPECT_THROW(Actuator(device, absent), OperationError);
}

TEST_F(GuardedThimble, NobodyElseGetsThePort) {
  const Actuator first(device, options());
  for (const std::string& guard : {guard_program(), std::string()}) {
    ActuatorOptions second = options();
    second.guard_program = guard;
    try {
      const Actuator actuator(device, second);
      FAIL();
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("another program uses it"));
    }
  }
}

TEST_F(GuardedThimble, OneThatWaitsForAProcessorIsNotTakenForOneThatHangs) {
  GuardProcess guard(guard_program(), device->home(), setup());
  ASSERT_EQ(guard.start(false), "");
  ASSERT_TRUE(soon([&] {
    guard.submit(wanted, DeviceState::kRendering);
    return guard.channel().commands_sent > 1;  // it has asked for its own priority by then
  }));
  // Something that never pauses, and comes first, has the guard's only processor.
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<std::size_t>(::sched_getcpu()), &one);
  ASSERT_EQ(::sched_setaffinity(guard.process(), sizeof one, &one), 0);
  const sched_param least{.sched_priority = 0};
  ASSERT_EQ(::sched_setscheduler(guard.process(), SCHED_OTHER, &least), 0);
  std::atomic<bool> busy{true};
  std::atomic<bool> may_come_first{true};
  std::thread first([&] {
    const sched_param priority{.sched_priority = 1};
    may_come_first = ::sched_setaffinity(0, sizeof one, &one) == 0 &&
                     ::sched_setscheduler(0, SCHED_FIFO, &priority) == 0;
    while (may_come_first && busy.load(std::memory_order_relaxed)) continue;
  });
  double longest = 0.0;
  for (int k = 0; k < 40; ++k) {
    guard.submit(wanted, DeviceState::kRendering);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    longest = std::max(longest, guard.channel().silence(monotonic_time()));
  }
  busy = false;
  first.join();
  if (!may_come_first) GTEST_SKIP() << "needs the right to a real-time priority";
  EXPECT_GT(longest, GuardSilence::kLongest) << "or nothing is shown";
  EXPECT_EQ(guard.replacements(), 0U);
  EXPECT_FALSE(guard.channel().stop.is_stopped());
}

/// What happens to a guard, and the signal that does it.
struct GuardFault {
  const char* name;
  int signal;
};
class FaultyGuard : public GuardedThimble, public testing::WithParamInterface<GuardFault> {};
INSTANTIATE_TEST_SUITE_P(Faults, FaultyGuard,
                         testing::Values(GuardFault{"Killed", SIGKILL},
                                         GuardFault{"Stopped", SIGSTOP},
                                         GuardFault{"Crashed", SIGSEGV}),
                         [](const auto& fault) { return fault.param.name; });

TEST_P(FaultyGuard, IsReplacedByOneThatRetractsUntilItIsReleased) {
  GuardProcess guard(guard_program(), device->home(), setup());
  ASSERT_EQ(guard.start(false), "");
  const auto follow = [&](const std::function<bool()>& done) {
    for (int k = 0; k < 300; ++k) {
      guard.submit(wanted, DeviceState::kRendering);
      std::this_thread::sleep_for(std::chrono::milliseconds(33));
      if (done()) return true;
    }
    return false;
  };
  ASSERT_TRUE(follow([&] { return away_from(wanted) < kNear; }));
  const int first = guard.process();
  const std::ptrdiff_t descriptors = open_descriptors();
  const auto began = std::chrono::steady_clock::now();
  ASSERT_EQ(::kill(first, GetParam().signal), 0);
  while (!guard.channel().stop.is_stopped()) {
    ASSERT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(5));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const std::chrono::duration<double> noticed = std::chrono::steady_clock::now() - began;
  EXPECT_LT(noticed.count(), 0.1 + 0.4) << "0.1 s, and what a busy machine takes";
  EXPECT_EQ(guard.channel().stop.cause(), StopCause::kGuard);

  ASSERT_TRUE(follow([&] { return away_from(device->retracted()) < kNear; }));
  EXPECT_NE(guard.process(), first);
  EXPECT_TRUE(guard.is_served());
  EXPECT_EQ(guard.replacements(), 1U);
  EXPECT_EQ(open_descriptors(), descriptors) << "nothing of the first one is kept";
  for (int k = 0; k < 20; ++k) {
    guard.submit(wanted, DeviceState::kRendering);
    std::this_thread::sleep_for(std::chrono::milliseconds(33));
    EXPECT_LT(away_from(device->retracted()), kNear) << "nobody released it";
  }
  ASSERT_TRUE(guard.ask_release(guard.channel().stop.newest(), StopCause::kPerson));
  EXPECT_TRUE(follow([&] { return away_from(wanted) < kNear; }));
  guard.finish();
  EXPECT_FALSE(guard.is_served());
  EXPECT_LT(away_from(device->retracted()), kNear);
}

}  // namespace
}  // namespace softfinger
