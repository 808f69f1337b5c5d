// A guard process that the system, or what lies in its place, does not let be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <vector>

#include "../support/temporary_directory.hpp"
#include "guarded_thimble.hpp"
#include "softfinger/actuation/guard_process.hpp"
#include "softfinger/actuation/guard_socket.hpp"
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

/// The guard program with these as its socket and its memory (-1: none); its exit status.
int run_guard(int socket, int memory) {
  const pid_t process = ::fork();
  if (process == 0) {
    // Out of the way of each other first.
    const int from_socket = socket < 0 ? -1 : ::fcntl(socket, F_DUPFD, 100);
    const int from_memory = memory < 0 ? -1 : ::fcntl(memory, F_DUPFD, 100);
    for (int descriptor = 3; descriptor < 100; ++descriptor) ::close(descriptor);
    if (from_socket >= 0) ::dup2(from_socket, guard_socket::kSocket);
    if (from_memory >= 0) ::dup2(from_memory, guard_socket::kMemory);
    ::execl(SOFTFINGER_GUARD, SOFTFINGER_GUARD, nullptr);
    ::_exit(99);
  }
  int status = 0;
  ::waitpid(process, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

class GuardProgram : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends_.data()), 0);
    memory_ = ::memfd_create("line", MFD_CLOEXEC);
    ASSERT_GE(memory_, 0);
  }
  ~GuardProgram() override {
    for (const int descriptor : {ends_[0], ends_[1], memory_}) ::close(descriptor);
  }
  std::string answer() {
    std::string text;
    EXPECT_TRUE(guard_socket::receive(ends_[0], text, std::chrono::seconds(5)));
    return text;
  }
  std::array<int, 2> ends_{-1, -1};
  int memory_ = -1;
};

TEST_F(GuardProgram, IsOfNoUseByItself) { EXPECT_EQ(run_guard(-1, -1), 1); }

TEST_F(GuardProgram, SaysThatItIsOfAnotherVersionByTheSizeOfWhatIsShared) {
  ASSERT_EQ(::ftruncate(memory_, 4096), 0);
  EXPECT_EQ(run_guard(ends_[1], memory_), 1);
  EXPECT_THAT(answer(), HasSubstr("two versions"));
}

TEST_F(GuardProgram, EndsWhereNobodyTellsItWhatToGuard) {
  ASSERT_EQ(::ftruncate(memory_, sizeof(LineChannel)), 0);
  ::shutdown(ends_[0], SHUT_WR);
  EXPECT_EQ(run_guard(ends_[1], memory_), 1);
}

TEST_F(GuardProgram, SaysWhatIsWrongWithWhatItIsTold) {
  ASSERT_EQ(::ftruncate(memory_, sizeof(LineChannel)), 0);
  ASSERT_TRUE(guard_socket::send(ends_[0], "{}"));
  EXPECT_EQ(run_guard(ends_[1], memory_), 1);
  EXPECT_THAT(answer(), HasSubstr("not softfinger that started it"));
}

TEST_F(GuardProgram, EndsAfterSayingThatThePortCannotBeOpened) {
  ASSERT_EQ(::ftruncate(memory_, sizeof(LineChannel)), 0);
  const auto device = load_device(kThimble);
  ASSERT_TRUE(guard_socket::send(ends_[0], to_text({.device_file = kThimble,
                                                    .device_text = device->settings().text,
                                                    .line = {.port = "/dev/no-such-port"}})));
  EXPECT_EQ(run_guard(ends_[1], memory_), 0);
  EXPECT_THAT(answer(), HasSubstr("no such port"));
}

class GuardThatIsNotThereAgain : public GuardWithoutMeans,
                                 public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Places, GuardThatIsNotThereAgain, testing::Values("", "/bin/true"),
                         [](const auto& place) {
                           return *place.param == 0 ? "Removed" : "Exchanged";
                         });

TEST_F(GuardWithoutMeans, HearsAStopOnlyWhereItRuns) {
  GuardProcess guard(SOFTFINGER_GUARD, device->home(), setup());
  ASSERT_EQ(guard.start(false), "");
  EXPECT_TRUE(guard.would_hear_a_stop(std::chrono::seconds(10)));
  EXPECT_EQ(guard.channel().commands_sent, 0U) << "nothing moves for that";
  ASSERT_EQ(::kill(guard.process(), SIGSTOP), 0);
  EXPECT_FALSE(guard.would_hear_a_stop(std::chrono::milliseconds(50)));
  // Another one takes its place.
  EXPECT_TRUE(guard.would_hear_a_stop(std::chrono::seconds(10)));
}

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
  ASSERT_GE(killed, 1);  // what took its place may be among them already
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
