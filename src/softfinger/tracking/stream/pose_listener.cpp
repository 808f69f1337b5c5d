#include "softfinger/tracking/stream/pose_listener.hpp"

#include <array>
#include <vector>

#include "softfinger/threads/thread_clock.hpp"

namespace softfinger {
namespace {

constexpr double kLookUpEvery = 0.05;  // s, whether the end has come

}  // namespace

void PoseReception::receive(const PoseMessage& message, const Endpoint& from, double now,
                            PoseFeed& feed) {
  if (!sender_ || (from != *sender_ && now - heard_ > kLostAfter)) {
    sender_ = from;
    gate_ = SequenceGate();
    clock_.reset();
  }
  if (from != *sender_) return;
  if (message.sequence) {
    if (!gate_.admits(*message.sequence, now)) return;
    if (gate_.restarted()) clock_.reset();
  }
  heard_ = now;
  if (message.valid) {
    feed.offer(message.X_WFt, message.time ? clock_.local_time(*message.time, now) : now, now);
  } else {
    feed.lose();
  }
}

PoseListener::PoseListener(const Endpoint& own, Decode decode, const Pose& start)
    : socket_(own), decode_(decode), feed_(start), thread_([this] { serve(); }) {}

PoseListener::~PoseListener() {
  ending_ = true;
  thread_.join();
}

TrackedPose PoseListener::sample(double time) { return feed_.sample(time, monotonic_time()); }

void PoseListener::serve() {
  // Of no priority: a flood of datagrams must not keep the loop from its work.
  std::vector<std::uint8_t> buffer(kLargestDatagram);
  PoseReception reception;
  const std::array<int, 1> sockets{socket_.descriptor()};
  while (!ending_.load(std::memory_order_relaxed)) {
    wait_for_datagram(sockets, kLookUpEvery);
    while (const auto datagram = socket_.receive(buffer)) {
      const auto message = decode_(std::span(buffer).first(datagram->size));
      if (message) reception.receive(*message, datagram->from, monotonic_time(), feed_);
      if (ending_.load(std::memory_order_relaxed)) return;
    }
  }
}

}  // namespace softfinger
