#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <thread>

#include "softfinger/tracking/stream/pose_feed.hpp"
#include "softfinger/tracking/stream/pose_message.hpp"
#include "softfinger/tracking/stream/sender_clock.hpp"
#include "softfinger/tracking/stream/sequence_gate.hpp"
#include "softfinger/wire/udp_socket.hpp"

namespace softfinger {

/// Which of the poses that arrive at a port is the newest, and when it was true. The first sender
/// keeps the port until it has been silent for kLostAfter: two hands never share a finger.
class PoseReception {
 public:
  /// Takes over a message that arrived at `now` (s, monotonic clock) or leaves it out.
  void receive(const PoseMessage& message, const Endpoint& from, double now, PoseFeed& feed);

 private:
  std::optional<Endpoint> sender_;
  double heard_ = 0.0;  ///< when the sender was last let through
  SequenceGate gate_;
  SenderClock clock_;
};

/// A tracker that others send poses to, one datagram each; a thread of its own receives them.
/// Datagrams that `Decode` refuses are as if they had not come. Has no end.
class PoseListener final : public Tracker {
 public:
  using Decode = std::optional<PoseMessage> (*)(std::span<const std::uint8_t>);

  /// Receives at `own`, its port 0: any free one. `start`: see PoseFeed. Throws InputError, see
  /// UdpSocket.
  PoseListener(const Endpoint& own, Decode decode, const Pose& start = {});
  ~PoseListener() override;
  PoseListener(const PoseListener&) = delete;
  PoseListener& operator=(const PoseListener&) = delete;

  [[nodiscard]] const Endpoint& address() const { return socket_.local(); }
  [[nodiscard]] TrackedPose sample(double time) override;
  [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }

 private:
  void serve();

  UdpSocket socket_;
  Decode decode_;
  PoseFeed feed_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace softfinger
