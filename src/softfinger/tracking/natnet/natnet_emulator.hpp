#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "softfinger/tracking/natnet/natnet_encoding.hpp"
#include "softfinger/tracking/tracker.hpp"
#include "softfinger/tracking/tracker_spec.hpp"
#include "softfinger/wire/udp_socket.hpp"

namespace softfinger {

/// A NatNet server with one moving rigid body, in wall time, with a thread of its own: to a client
/// it is Motive, streaming. Time begins when the first client connects; nothing is sent before.
class NatNetEmulator {
 public:
  /// Where the body is at a time of its motion (s).
  using Motion = std::function<TrackedPose(double)>;

  struct Options {
    std::uint32_t address = kLoopback;  ///< own; multicast leaves by its interface
    std::uint16_t port = 0;             ///< of the command socket; 0: any free one
    NatNetVersion version{4, 1};
    bool multicast = false;
    std::uint32_t group = kNatNetGroup;
    /// Unicast frames go to the client's data port, else to where its commands come from.
    bool to_data_port = false;
    double rate = 240.0;  ///< frames per s
    std::string body = "index";
    UpAxis up = UpAxis::kY;
    double scale = 1.0;           ///< metres per unit that it streams
    double exposure_age = 0.004;  ///< s, of the cameras' exposure when a frame is sent
    double clock_ahead = 1e5;     ///< s, of its clock before ours
    std::uint32_t seed = 1;
    // What may go wrong, as probabilities of each frame.
    double loss = 0.0;
    double duplication = 0.0;
    double reordering = 0.0;  ///< held back until after a later frame
    bool mute = false;        ///< answers, but sends no frames
  };

  /// Throws InputError where the port is in use.
  NatNetEmulator(Options options, Motion motion);
  ~NatNetEmulator();
  NatNetEmulator(const NatNetEmulator&) = delete;
  NatNetEmulator& operator=(const NatNetEmulator&) = delete;

  /// Where it listens for commands.
  [[nodiscard]] const Endpoint& address() const { return command_.local(); }
  /// Time of its motion, s; 0 until a client connects.
  [[nodiscard]] double time() const { return time_.load(std::memory_order_relaxed); }

 private:
  struct Client {
    Endpoint place;
    double heard = 0.0;
  };

  void serve();
  void answer(std::span<const std::uint8_t> datagram, const Endpoint& from, double now);
  void hear(const Endpoint& client, double now);
  void send_frame(double now);
  void send_to_clients(std::span<const std::uint8_t> datagram, double now);
  [[nodiscard]] std::uint64_t ticks(double now) const;
  [[nodiscard]] bool happens(double probability);

  Options options_;
  Motion motion_;
  UdpSocket command_;
  UdpSocket data_;
  NatNetServer self_;
  NatNetVersion version_;  ///< of the stream: its own, or one asked for
  std::vector<NatNetBody> bodies_;
  std::vector<Client> clients_;
  std::optional<double> began_;  ///< when the first client connected
  double next_frame_ = 0.0;
  std::int32_t number_ = 0;
  std::vector<NatNetDatagram> held_back_;
  std::mt19937 random_;
  std::atomic<double> time_{0.0};
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace softfinger
