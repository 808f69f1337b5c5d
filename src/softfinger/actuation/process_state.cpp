#include "softfinger/actuation/process_state.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <ctime>
#include <string_view>

namespace softfinger {

ProcessState process_state(int process) noexcept {
  std::array<char, 64> name{};
  std::snprintf(name.data(), name.size(), "/proc/%d/stat", process);
  const int file = ::open(name.data(), O_RDONLY | O_CLOEXEC);
  std::array<char, 256> text{};
  // Of a process that is gone there is no file, nothing is read, and no letter is found.
  [[maybe_unused]] const ssize_t got = ::read(file, text.data(), text.size());
  ::close(file);
  // "PID (NAME) S ...", where the name may have anything in it.
  const std::string_view line(text.data(), text.size());
  const std::size_t end = line.rfind(") ");
  if (end == std::string_view::npos) return ProcessState::kGone;
  switch (line[end + 2]) {
    case 'R':
      return ProcessState::kRunning;
    case 'S':
    case 'I':
      return ProcessState::kAsleep;
    case 'D':
      return ProcessState::kInDriver;
    case 'T':
    case 't':
      return ProcessState::kStopped;
    default:
      return ProcessState::kGone;
  }
}

double process_cpu_time(int process) noexcept {
  clockid_t clock{};
  timespec used{};
  if (::clock_getcpuclockid(process, &clock) != 0 || ::clock_gettime(clock, &used) != 0) return 0.0;
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

}  // namespace softfinger
