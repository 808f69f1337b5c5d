#include "softfinger/actuation/guard_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <new>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "softfinger/actuation/guard_socket.hpp"
#include "softfinger/actuation/process_state.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

using std::chrono::milliseconds;

/// To start, to load the device and to open the port.
constexpr milliseconds kStartTime{10'000};
constexpr milliseconds kLookEvery{10};
/// For one that was killed, or has said its last, to be gone; in a driver that hangs it may stay.
constexpr milliseconds kLongestDeath{1'000};
/// Descriptors go to the guard by low numbers; none of their sources may be one of those.
constexpr int kAboveGuardDescriptors = 64;

class SpawnPlan {
 public:
  SpawnPlan() {
    posix_spawn_file_actions_init(&actions_);
    posix_spawnattr_init(&attributes_);
  }
  ~SpawnPlan() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
    for (const int descriptor : copies_) ::close(descriptor);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;

  /// A session and signals of its own: Ctrl-C in the terminal is not for the guard. And none of our
  /// standard streams: who waits for their end must not wait for the guard.
  void separate() {
    const sigset_t none{};
    sigset_t all;
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    posix_spawnattr_setflags(&attributes_,
                             POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
      posix_spawn_file_actions_addopen(&actions_, stream, "/dev/null", O_RDWR, 0);
    }
  }
  void hand_over(int descriptor, int as) {
    const int copy = ::fcntl(descriptor, F_DUPFD_CLOEXEC, kAboveGuardDescriptors);
    copies_.push_back(copy);
    posix_spawn_file_actions_adddup2(&actions_, copy, as);
  }
  /// 0 or an error number.
  int spawn(int& process, const std::string& program) {
    std::string name = program;
    std::array<char*, 2> arguments = {name.data(), nullptr};
    return ::posix_spawn(&process, program.c_str(), &actions_, &attributes_, arguments.data(),
                         environ);
  }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
  std::vector<int> copies_;
};

}  // namespace

GuardProcess::GuardProcess(std::filesystem::path program, const Configuration& home,
                           GuardSetup setup)
    : program_(std::move(program)),
      setup_(std::move(setup)),
      memory_(::memfd_create("softfinger-line", MFD_CLOEXEC)) {
  void* bytes = MAP_FAILED;
  if (memory_ >= 0 && ::ftruncate(memory_, sizeof(LineChannel)) == 0) {
    bytes = ::mmap(nullptr, sizeof(LineChannel), PROT_READ | PROT_WRITE, MAP_SHARED, memory_, 0);
  }
  if (bytes == MAP_FAILED) {
    if (memory_ >= 0) ::close(memory_);
    throw OperationError("the system has no memory to share with a guard process");
  }
  channel_ = new (bytes) LineChannel(home);
}

GuardProcess::~GuardProcess() {
  finish();
  ::munmap(channel_, sizeof(LineChannel));
  ::close(memory_);
}

void GuardProcess::spawn() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw OperationError("the system has no more sockets");
  }
  socket_ = ends[0];
  SpawnPlan plan;
  plan.separate();
  plan.hand_over(ends[1], guard_socket::kSocket);
  plan.hand_over(memory_, guard_socket::kMemory);
  plan.hand_over(wake_descriptor(), guard_socket::kWake);
  pid_t process{};
  const int error = plan.spawn(process, program_.string());
  ::close(ends[1]);
  if (error == 0) {
    process_ = process;
    began_ = std::chrono::steady_clock::now();
    return;
  }
  close_socket();
  throw OperationError(fmt::format("{}: the guard of the device's port cannot be started: {}",
                                   program_.string(), std::generic_category().message(error)));
}

std::string GuardProcess::tell_and_ask() {
  std::string answer;
  if (!guard_socket::send(socket_, to_text(setup_)) ||
      !guard_socket::receive(socket_, answer, kStartTime)) {
    return "its guard process does not answer";
  }
  return answer;
}

std::string GuardProcess::start(bool wait_for_device) {
  setup_.wait_for_device = wait_for_device;
  spawn();
  std::string reason = tell_and_ask();
  if (reason.empty() || wait_for_device) {
    watch_ = std::thread([this] { watch(); });
    return reason;
  }
  ::kill(process_, SIGKILL);  // it serves nobody
  ::waitpid(process_, nullptr, 0);
  process_ = -1;
  close_socket();
  return reason;
}

void GuardProcess::close_socket() noexcept {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

bool GuardProcess::has_ended() noexcept {
  return process_ < 0 || ::waitpid(process_, nullptr, WNOHANG) != 0;
}

bool GuardProcess::hangs() noexcept {
  const double beat = channel_->beat.load();
  const double silence = channel_->silence(monotonic_time());
  return silence_.tells_that_it_hangs(beat, silence, process_cpu_time(process_), [this] {
    wake();  // what only sleeps too long is ready to run from here on
    const ProcessState state = process_state(process_);
    return GuardSilence::Seen{channel_->beat.load(), state};
  });
}

/// False: not any more.
bool GuardProcess::replace() noexcept {
  const auto now = std::chrono::steady_clock::now();
  const bool short_life = std::chrono::duration<double>(now - began_).count() < kShortLife;
  short_lives_ = short_life ? short_lives_ + 1 : 0;
  if (short_lives_ > kMostReplacements) return false;
  close_socket();
  setup_.wait_for_device = true;
  silence_ = {};
  try {
    spawn();
    (void)tell_and_ask();  // where the port cannot be opened at once it goes on trying
  } catch (const std::exception&) {
    return false;
  }
  ++replacements_;
  return true;
}

void GuardProcess::await_death() noexcept {
  const auto until = std::chrono::steady_clock::now() + kLongestDeath;
  while (!has_ended() && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(milliseconds(1));
  }
}

void GuardProcess::watch() noexcept {
  while (true) {
    std::this_thread::sleep_for(kLookEvery);
    const bool ended = has_ended();
    // One that ended as it was told to has said so; closing a port may take it a while yet.
    if (channel_->ending && channel_->state.load() == DeviceState::kStopped) {
      await_death();
      break;
    }
    if (!ended && !hangs()) continue;
    channel_->stop.stop(StopCause::kGuard);
    channel_->connected = false;
    channel_->state = DeviceState::kDisconnected;
    if (!ended) {
      ::kill(process_, SIGKILL);
      await_death();
    }
    if (!replace()) break;
  }
  process_ = -1;
  channel_->connected = false;
  channel_->state = DeviceState::kStopped;
}

void GuardProcess::finish() noexcept {
  channel_->ending = true;
  wake();
  if (watch_.joinable()) watch_.join();
  close_socket();
}

}  // namespace softfinger
