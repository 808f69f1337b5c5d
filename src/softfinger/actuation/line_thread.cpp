#include "softfinger/actuation/line_thread.hpp"

#include <utility>

namespace softfinger {

LineThread::LineThread(std::shared_ptr<const Device> device, const ServoLine::Options& options)
    : bytes_(device->home()), line_(std::move(device), options, bytes_, wake_descriptor()) {
  channel_ = &bytes_;
}

LineThread::~LineThread() { finish(); }

std::string LineThread::start(bool wait_for_device) {
  std::string reason = line_.open();
  if (reason.empty() || wait_for_device) {
    thread_ = std::thread([this] { line_.serve(); });
  }
  return reason;
}

void LineThread::finish() noexcept {
  if (!thread_.joinable()) return;
  bytes_.ending = true;
  wake();
  thread_.join();
}

}  // namespace softfinger
