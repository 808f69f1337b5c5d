#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <exception>

#include "softfinger/actuation/guard_process.hpp"
#include "softfinger/actuation/guard_socket.hpp"
#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

/// The channel that the parent shares; null: there is none.
LineChannel* shared_channel() {
  struct stat status {};
  if (::fstat(guard_socket::kMemory, &status) != 0 ||
      status.st_size != static_cast<off_t>(sizeof(LineChannel))) {
    return nullptr;
  }
  void* bytes = ::mmap(nullptr, sizeof(LineChannel), PROT_READ | PROT_WRITE, MAP_SHARED,
                       guard_socket::kMemory, 0);
  return bytes == MAP_FAILED ? nullptr : static_cast<LineChannel*>(bytes);
}

int serve(LineChannel& channel) {
  std::string text;
  if (!guard_socket::receive(guard_socket::kSocket, text, std::chrono::seconds(5))) return 1;
  std::string reason;
  try {
    const GuardedDevice guarded = read_guard_setup(text);
    ServoLine line(guarded.device, guarded.setup.line, channel, guard_socket::kWake,
                   guard_socket::kSocket);
    reason = line.open();
    // Where the system lets it: memory that was put aside comes back too late.
    ::mlockall(MCL_CURRENT);
    const bool serves = reason.empty() || guarded.setup.wait_for_device;
    if (guard_socket::send(guard_socket::kSocket, reason) && serves) line.serve();
    return 0;
  } catch (const std::exception& error) {
    guard_socket::send(guard_socket::kSocket, error.what());
    return 1;
  }
}

}  // namespace

int serve_guarded_line() {
  // What else the parent has open (a page's port, a recording) is none of the guard's business.
  ::close_range(guard_socket::kFirstForeign, ~0U, 0);
  // It ends when its parent does, and never before the device is retracted.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  LineChannel* channel = shared_channel();
  if (channel != nullptr) return serve(*channel);
  guard_socket::send(guard_socket::kSocket,
                     "the program and its softfinger-guard are of two versions; install them anew");
  return 1;
}

}  // namespace softfinger
