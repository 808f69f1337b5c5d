#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>

#include "softfinger/geometry/pose.hpp"
#include "softfinger/wire/udp_socket.hpp"

namespace softfinger {

/// Where a finger of the soak is, t s after the start: it presses a ball of 20 mm, goes round on it
/// and lets go, at no more than 30 mm/s.
[[nodiscard]] Pose soaked_finger(double time);

/// What goes wrong with a tracker.
struct PoseTrouble {
  double loss = 0.0;  ///< probability of each datagram, as the next two
  double duplication = 0.0;
  double reordering = 0.0;  ///< held back behind later ones
  /// How far the pose seems to be off, along x, m; empty: not.
  std::function<double(double time, std::uint32_t number)> jump = nullptr;
  /// How far the sender's clock is ahead, s; empty: not.
  std::function<double(double time)> clock_ahead = nullptr;
};

/// A tracker of 120 Hz that sends to tracker `udp` on loopback, on a thread of its own.
class PoseSender {
 public:
  PoseSender(std::uint16_t port, PoseTrouble trouble);
  ~PoseSender();
  PoseSender(const PoseSender&) = delete;
  PoseSender& operator=(const PoseSender&) = delete;

 private:
  void serve();

  std::uint16_t port_;
  PoseTrouble trouble_;
  UdpSocket socket_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace softfinger
