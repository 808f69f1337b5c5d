#include "softfinger/session/live_device.hpp"

#include <chrono>
#include <utility>

#include "softfinger/threads/thread_priority.hpp"

namespace softfinger {

LiveDevice::LiveDevice(FingerChain& chain, const FingerModel& model, std::unique_ptr<LiveTwin> twin)
    : chain_(chain),
      handover_(model),
      feedback_(initial_feedback(chain.device())),
      twin_(std::move(twin)) {}

LiveDevice::~LiveDevice() {
  stop();
  join();
}

void LiveDevice::start(RecordingWriter* recording, const std::function<void()>& on_loop_thread) {
  thread_ = std::thread([this, recording, on_loop_thread] { serve(recording, on_loop_thread); });
  if (twin_) twin_->start();
}

void LiveDevice::join() {
  if (thread_.joinable()) thread_.join();
  if (twin_) twin_->end();
}

void LiveDevice::hand_over(const TickInput& input) {
  handover_.hand_over(input, chain_.virtual_finger());
}

void LiveDevice::hand_over_again() {
  const TickInput& last = handover_.last();
  if (last.step == 0) return;
  const auto period = std::chrono::duration<double>(1.0 / device_rate(chain_.device().device()));
  const auto now = std::chrono::steady_clock::now();
  if (now - last.handed < period) return;
  const StepRecord& step = chain_.loop().record();
  hand_over(
      {.step = step.step, .time = step.time, .tracked = last.tracked, .taken = now, .handed = now});
}

void LiveDevice::take_feedback() {
  if (!feedback_.refresh()) return;
  const TickRecord& tick = feedback_.latest().tick;
  chain_.know(tick.tick, tick.hash);
}

void LiveDevice::serve(RecordingWriter* recording, const std::function<void()>& on_loop_thread) {
  prefer_this_thread(LoopThread::kDevice);
  const auto period = std::chrono::duration<double>(1.0 / device_rate(chain_.device().device()));
  bool first = true;
  while (const HandedTick* handed = handover_.take()) {
    const auto taken = std::chrono::steady_clock::now();
    const TickRecord& tick = chain_.tick(handed->input, handed->finger());
    // Recorded before it is told: a recorded step never names a tick that is not recorded.
    if (recording != nullptr) recording->push(tick);
    summary_.add(tick);
    read_device(chain_.device(), feedback_.draft());
    feedback_.publish();
    if (twin_) twin_->offer(tick, handed->contact);
    if (first && on_loop_thread) on_loop_thread();
    first = false;
    // The next one is there already.
    if (std::chrono::steady_clock::now() - taken > period) rest_a_moment();
  }
}

}  // namespace softfinger
