#include "softfinger/actuation/line_end.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <thread>

#include "softfinger/base/error.hpp"
#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {

LineEnd::LineEnd() : wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (wake_ < 0) throw OperationError("the system has no more event descriptors");
}

LineEnd::~LineEnd() { ::close(wake_); }

void LineEnd::wake() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t put = ::write(wake_, &one, sizeof one);
}

bool LineEnd::would_hear_a_stop(std::chrono::milliseconds patience) noexcept {
  const auto until = std::chrono::steady_clock::now() + patience;
  const std::uint32_t question = channel_->question.fetch_add(1) + 1;
  wake();
  while (channel_->answer.load() != question) {
    if (std::chrono::steady_clock::now() >= until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

void LineEnd::submit(const Configuration& q, DeviceState state) noexcept {
  LineChannel::Wanted& draft = channel_->wanted.draft();
  draft.q = q;
  draft.state = state;
  draft.formed = monotonic_time();
  draft.number = ++submitted_;
  draft.seal = draft.seal_of_this();
  channel_->wanted.publish();
  wake();
}

StopLatch::Number LineEnd::stop(StopCause cause) noexcept {
  const StopLatch::Number number = channel_->stop.stop(cause);
  wake();
  return number;
}

bool LineEnd::ask_release(StopLatch::Number number, StopCause by) noexcept {
  const bool asked = channel_->stop.ask_release(number, by);
  if (asked) wake();
  return asked;
}

std::optional<CommandDelivery> LineEnd::take_delivery() noexcept {
  if (!channel_->delivery.refresh()) return std::nullopt;
  return channel_->delivery.latest();
}

bool LineEnd::read_joints(JointAngles& joints) noexcept {
  channel_->report.refresh();
  if (!channel_->report.latest().known) return false;
  joints = channel_->report.latest().joints;
  return true;
}

}  // namespace softfinger
