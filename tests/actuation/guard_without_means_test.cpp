// A guard process that the system, or what lies in its place, does not let be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

#include "../support/temporary_directory.hpp"
#include "guarded_thimble.hpp"
#include "softfinger/actuation/guard_process.hpp"
#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

/// Only `left` descriptors can be had while it lives.
class FewDescriptors {
 public:
  explicit FewDescriptors(std::size_t left) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    rlimit few = before_;
    few.rlim_cur = std::min<rlim_t>(few.rlim_cur, 256);
    ::setrlimit(RLIMIT_NOFILE, &few);
    for (int one = 0; (one = ::open("/dev/null", O_RDONLY | O_CLOEXEC)) >= 0;)
      taken_.push_back(one);
    for (; left > 0 && !taken_.empty(); --left) give_back();
  }
  ~FewDescriptors() {
    while (!taken_.empty()) give_back();
    ::setrlimit(RLIMIT_NOFILE, &before_);
  }
  FewDescriptors(const FewDescriptors&) = delete;
  FewDescriptors& operator=(const FewDescriptors&) = delete;

 private:
  void give_back() {
    ::close(taken_.back());
    taken_.pop_back();
  }
  rlimit before_{};
  std::vector<int> taken_;
};

class GuardWithoutMeans : public GuardedThimble {
 protected:
  void expect_refused(GuardProcess& guard, const char* words) {
    try {
      static_cast<void>(guard.start(false));
      FAIL();
    } catch (const OperationError& error) {
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
    EXPECT_LT(guard.process(), 0);
    EXPECT_FALSE(guard.is_served());
  }
  TemporaryDirectory directory_;
};

TEST_F(GuardWithoutMeans, SaysSoWhereTheSystemHasNoMoreDescriptors) {
  {
    const FewDescriptors none(0);
    EXPECT_THROW(GuardProcess(SOFTFINGER_GUARD, device->home(), setup()), OperationError);
  }
  {
    const FewDescriptors only_the_event(1);
    EXPECT_THROW(GuardProcess(SOFTFINGER_GUARD, device->home(), setup()), OperationError);
  }
  GuardProcess guard(SOFTFINGER_GUARD, device->home(), setup());
  {
    const FewDescriptors no_sockets(0);
    expect_refused(guard, "no more sockets");
  }
  EXPECT_EQ(guard.start(false), "") << "as soon as there are some";
}

TEST_F(GuardWithoutMeans, SaysSoWhereItIsNoProgram) {
  const fs::path text = directory_ / "no-program";
  std::ofstream(text) << "not a program\n";
  GuardProcess guard(text, device->home(), setup());
  expect_refused(guard, "cannot be started");
}

TEST_F(GuardWithoutMeans, SaysSoWhereItIsAnotherProgram) {
  GuardProcess guard("/bin/true", device->home(), setup());
  EXPECT_THAT(guard.start(false), HasSubstr("does not answer"));
  EXPECT_FALSE(guard.is_served());
}

class GuardThatIsNotThereAgain : public GuardWithoutMeans,
                                 public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Places, GuardThatIsNotThereAgain, testing::Values("", "/bin/true"),
                         [](const auto& place) {
                           return *place.param == 0 ? "Removed" : "Exchanged";
                         });

TEST_P(GuardThatIsNotThereAgain, IsToldAsLost) {
  const fs::path program = directory_ / "softfinger-guard";
  fs::create_symlink(SOFTFINGER_GUARD, program);
  ActuatorOptions guarded = options();
  guarded.guard_program = program;
  Actuator actuator(device, guarded);
  ASSERT_TRUE(follow(actuator, wanted, [&] { return away_from(wanted) < kNear; }));
  while (actuator.take_event()) continue;
  fs::remove(program);
  if (*GetParam() != 0) fs::create_symlink(GetParam(), program);
  int killed = 0;
  for (const auto& entry : fs::directory_iterator("/proc/self/task")) {
    std::ifstream children(entry.path() / "children");
    for (int child = 0; children >> child; ++killed) ::kill(child, SIGKILL);
  }
  ASSERT_EQ(killed, 1);
  bool lost = false;
  EXPECT_TRUE(soon([&] {
    while (const auto event = actuator.take_event()) {
      if (*event != ActuatorEvent::kGuardLost) continue;
      lost = true;
      EXPECT_THAT(actuator.message(*event), HasSubstr("take it off"));
    }
    return lost;
  }));
  EXPECT_FALSE(actuator.connected());
  EXPECT_TRUE(actuator.stop_latch().is_stopped());
}

}  // namespace
}  // namespace softfinger
