// A guard process that the system, or what lies in its place, does not let be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "../support/folders.hpp"
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
    EXPECT_THROW(GuardProcess(guard_program(), device->home(), setup()), OperationError);
  }
  {
    const FewDescriptors only_the_event(1);
    EXPECT_THROW(GuardProcess(guard_program(), device->home(), setup()), OperationError);
  }
  GuardProcess guard(guard_program(), device->home(), setup());
  {
    const FewDescriptors no_sockets(0);
    expect_refused(guard, "no more sockets");
  }
  EXPECT_EQ(guard.start(false), "") << "as soon as there are some";
}

TEST_F(GuardWithoutMeans, SaysSoWhereTheSystemHasNoMemoryToShare) {
  const auto before_signal = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  rlimit none = before;
  none.rlim_cur = 0;
  const std::ptrdiff_t descriptors = open_descriptors();
  ::setrlimit(RLIMIT_FSIZE, &none);
  EXPECT_THROW(GuardProcess(guard_program(), device->home(), setup()), OperationError);
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, before_signal);
  EXPECT_EQ(open_descriptors(), descriptors);
}

TEST_F(GuardWithoutMeans, SaysSoWhereItIsNoProgram) {
  const fs::path text = directory_ / "no-program";
  std::ofstream(text) << "not a program\n";
  GuardProcess guard(text, device->home(), setup());
  const std::ptrdiff_t before = open_descriptors();
  const int input = ::fcntl(STDIN_FILENO, F_GETFD);
  expect_refused(guard, "cannot be started");
  EXPECT_EQ(open_descriptors(), before) << "and keeps nothing open";
  const int anothers = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  guard.finish();
  EXPECT_EQ(::close(anothers), 0) << "and closes nothing that is not its own any more";
  EXPECT_EQ(::fcntl(STDIN_FILENO, F_GETFD), input);
}

TEST_F(GuardWithoutMeans, SaysSoWhereItIsAnotherProgram) {
  GuardProcess guard("/bin/true", device->home(), setup());
  const std::ptrdiff_t before = open_descriptors();
  EXPECT_THAT(guard.start(false), HasSubstr("does not answer"));
  EXPECT_FALSE(guard.is_served());
  EXPECT_EQ(open_descriptors(), before);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "nobody is left to be waited for";
}

TEST_F(GuardWithoutMeans, KeepsNobodyWherePortsAreNotThere) {
  GuardSetup absent = setup();
  absent.line.port = "/dev/softfinger-no-such-port";
  GuardProcess guard(guard_program(), device->home(), absent);
  const std::ptrdiff_t before = open_descriptors();
  EXPECT_THAT(guard.start(false), HasSubstr("no such port"));
  EXPECT_EQ(open_descriptors(), before);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "nobody is left to be waited for";
}

/// Signals (bit n - 1 of signal n) on a line of /proc/PID/status.
std::uint64_t signals_on(const std::string& said, const std::string& line) {
  const std::size_t at = said.find(line + ":\t");
  EXPECT_NE(at, std::string::npos) << said;
  return std::stoull(said.substr(at + line.size() + 2, 16), nullptr, 16);
}

// Neither signals, nor session, nor streams.
TEST_F(GuardWithoutMeans, HasNothingOfItsParentButWhatItIsGiven) {
  const fs::path program = directory_ / "guard";
  std::ofstream(program) << "#!/bin/sh\n"
                            "exec 9> \"$0.said\"\n"
                            "grep '^Sig' /proc/self/status >&9\n"
                            "echo session: $(cut -d' ' -f6 /proc/$$/stat) of $$ >&9\n"
                            "for i in 0 1 2; do echo stream: $(readlink /proc/$$/fd/$i) >&9; done\n"
                            "for i in 3 4 5; do echo given: $(readlink /proc/$$/fd/$i) >&9; done\n";
  fs::permissions(program, fs::perms::owner_all);
  sigset_t one;
  sigset_t before;
  sigemptyset(&one);
  sigaddset(&one, SIGUSR2);
  ::sigprocmask(SIG_BLOCK, &one, &before);
  constexpr std::array kIgnored{SIGUSR1, SIGALRM, SIGTERM, SIGWINCH, SIGXFSZ};
  for (const int signal : kIgnored) ASSERT_EQ(std::signal(signal, SIG_IGN), SIG_DFL);
  {
    GuardProcess guard(program, device->home(), setup());
    EXPECT_THAT(guard.start(false), HasSubstr("does not answer"));
  }
  for (const int signal : kIgnored) std::signal(signal, SIG_DFL);
  ::sigprocmask(SIG_SETMASK, &before, nullptr);
  std::ifstream file(program.string() + ".said");
  const std::string said(std::istreambuf_iterator<char>(file), {});
  EXPECT_EQ(signals_on(said, "SigBlk"), 0U);
  constexpr std::uint64_t kAllButTheCLibrarysOwn = (std::uint64_t{1} << 31U) - 1U;
  EXPECT_EQ(signals_on(said, "SigIgn") & kAllButTheCLibrarysOwn, 0U);
  const std::size_t session = said.find("session: ");
  ASSERT_NE(session, std::string::npos) << said;
  int leader = 0;
  int process = 1;
  EXPECT_EQ(std::sscanf(said.c_str() + session, "session: %d of %d", &leader, &process), 2);
  EXPECT_EQ(leader, process) << said;
  EXPECT_THAT(said, HasSubstr("stream: /dev/null\nstream: /dev/null\nstream: /dev/null\n"));
  EXPECT_THAT(said, HasSubstr("given: socket:"));
  EXPECT_THAT(said, HasSubstr("given: /memfd:softfinger-line"));
  EXPECT_THAT(said, HasSubstr("given: anon_inode:[eventfd]"));
}

/// The guard program with these as its socket, its memory and something that is none of its
/// business
/// (-1: none); its exit status.
int run_guard(int socket, int memory, int foreign = -1) {
  const char* const guard = guard_program().c_str();
  const pid_t process = ::fork();
  if (process == 0) {
    // Out of the way of each other first.
    const int from_socket = socket < 0 ? -1 : ::fcntl(socket, F_DUPFD, 100);
    const int from_memory = memory < 0 ? -1 : ::fcntl(memory, F_DUPFD, 100);
    const int from_foreign = foreign < 0 ? -1 : ::fcntl(foreign, F_DUPFD, 100);
    for (int descriptor = 3; descriptor < 100; ++descriptor) ::close(descriptor);
    if (from_socket >= 0) ::dup2(from_socket, guard_socket::kSocket);
    if (from_memory >= 0) ::dup2(from_memory, guard_socket::kMemory);
    if (from_foreign >= 0) ::dup2(from_foreign, guard_socket::kFirstForeign);
    for (int descriptor = 100; descriptor < 120; ++descriptor) ::close(descriptor);
    ::execl(guard, guard, nullptr);
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
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(run_guard(ends_[1], memory_), 1);
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(9)) << "5 s";
  ::shutdown(ends_[0], SHUT_WR);
  EXPECT_EQ(run_guard(ends_[1], memory_), 1) << "where nobody can";
}

// A page's port, say, would stay taken for as long as a guard retracts.
TEST_F(GuardProgram, ClosesWhatElseItsParentHasOpen) {
  ASSERT_EQ(::ftruncate(memory_, sizeof(LineChannel)), 0);
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe2(pipe.data(), O_CLOEXEC), 0);
  std::thread guard([&] { EXPECT_EQ(run_guard(ends_[1], memory_, pipe[1]), 1); });
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // it has its descriptors by then
  ::close(pipe[1]);
  pollfd end{.fd = pipe[0], .events = POLLIN, .revents = {}};
  EXPECT_EQ(::poll(&end, 1, 3000), 1) << "while it waits to be told";
  EXPECT_NE(end.revents & POLLHUP, 0);
  ::shutdown(ends_[0], SHUT_WR);
  guard.join();
  ::close(pipe[0]);
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
  GuardProcess guard(guard_program(), device->home(), setup());
  ASSERT_EQ(guard.start(false), "");
  EXPECT_TRUE(guard.would_hear_a_stop(std::chrono::seconds(10)));
  EXPECT_EQ(guard.channel().commands_sent, 0U) << "nothing moves for that";
  ASSERT_EQ(::kill(guard.process(), SIGSTOP), 0);
  EXPECT_FALSE(guard.would_hear_a_stop(std::chrono::milliseconds(50)));
  // Another one takes its place.
  EXPECT_TRUE(guard.would_hear_a_stop(std::chrono::seconds(10)));
}

/// A guard by a name that may come to mean something else.
class ExchangedGuard : public GuardWithoutMeans {
 protected:
  ExchangedGuard() { fs::create_symlink(guard_program(), program_); }
  void exchange(const std::string& script) {
    fs::remove(program_);
    std::ofstream(program_) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(program_, fs::perms::owner_all);
  }
  bool led_to(GuardProcess& guard, const Configuration& q) {
    return soon([&] {
      guard.submit(wanted, DeviceState::kRendering);
      return away_from(q) < kNear;
    });
  }
  fs::path program_ = directory_ / "softfinger-guard";
};

TEST_F(ExchangedGuard, WhileAnotherTakesItsPlaceNobodyIsConnected) {
  GuardProcess guard(program_, device->home(), setup());
  ASSERT_EQ(guard.start(false), "");
  ASSERT_TRUE(led_to(guard, wanted));
  exchange("sleep 1");
  ::kill(guard.process(), SIGKILL);
  EXPECT_TRUE(soon([&] { return guard.channel().stop.is_stopped(); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // of the second that it takes
  EXPECT_FALSE(guard.channel().connected);
  EXPECT_EQ(guard.channel().state, DeviceState::kDisconnected);
  EXPECT_TRUE(guard.is_served());
}

TEST_F(ExchangedGuard, IsReplacedThreeTimesInARowAndNoMore) {
  GuardProcess guard(program_, device->home(), setup());
  ASSERT_EQ(guard.start(false), "");
  exchange("exit 0");
  ::kill(guard.process(), SIGKILL);
  EXPECT_TRUE(soon([&] { return !guard.is_served(); }));
  EXPECT_EQ(guard.replacements(), 3U);
  EXPECT_TRUE(soon([&] { return guard.channel().state == DeviceState::kStopped; }));
  EXPECT_FALSE(guard.channel().connected);
}

// A cable that is pulled takes guards with it that hang in their driver.
TEST_F(ExchangedGuard, ItsSuccessorWaitsForAPortThatIsNotThereAtOnce) {
  const fs::path port = directory_ / "port";
  fs::create_symlink(terminal.port(), port);
  GuardSetup by_name = setup();
  by_name.line.port = port;
  GuardProcess guard(program_, device->home(), by_name);
  ASSERT_EQ(guard.start(false), "");
  ASSERT_TRUE(led_to(guard, wanted));
  fs::remove(port);
  ::kill(guard.process(), SIGKILL);
  EXPECT_TRUE(soon([&] { return guard.replacements() == 1; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  EXPECT_EQ(guard.replacements(), 1U) << "one that waits is enough";
  EXPECT_FALSE(guard.channel().connected);
  fs::create_symlink(terminal.port(), port);
  EXPECT_TRUE(led_to(guard, device->retracted()));
}

TEST_F(ExchangedGuard, WaitsForAPortThatIsNotThereAtTheStart) {
  const fs::path port = directory_ / "port";
  GuardSetup by_name = setup();
  by_name.line.port = port;
  GuardProcess guard(program_, device->home(), by_name);
  EXPECT_THAT(guard.start(true), HasSubstr("no such port"));
  EXPECT_TRUE(guard.is_served());
  fs::create_symlink(terminal.port(), port);
  EXPECT_TRUE(led_to(guard, wanted));
  EXPECT_EQ(guard.replacements(), 0U);
}

// However long that takes.
TEST_F(ExchangedGuard, TheEndWaitsUntilTheDeviceIsRetracted) {
  GuardSetup slow = setup();
  const std::string rate = "joint_rate_deg_per_s = ";
  const std::size_t at = slow.device_text.find(rate);
  ASSERT_NE(at, std::string::npos);
  slow.device_text.replace(at, slow.device_text.find('\n', at) - at, rate + "10.0");
  GuardProcess guard(program_, device->home(), slow);
  ASSERT_EQ(guard.start(false), "");
  ASSERT_TRUE(led_to(guard, wanted));
  ASSERT_GT(away_from(device->retracted()), 0.3) << "two seconds of its way";
  guard.finish();
  EXPECT_LT(away_from(device->retracted()), kNear);
}

TEST_P(GuardThatIsNotThereAgain, IsToldAsLost) {
  const fs::path program = directory_ / "softfinger-guard";
  fs::create_symlink(guard_program(), program);
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
