#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "softfinger/tracking/natnet/natnet_session.hpp"
#include "softfinger/tracking/stream/pose_feed.hpp"
#include "softfinger/tracking/tracker_spec.hpp"
#include "softfinger/wire/udp_socket.hpp"

namespace softfinger {

/// How long a NatNet server may take for each stage of a connection, s.
inline constexpr double kNatNetPatience = 3.0;

/// A rigid body streamed by an OptiTrack NatNet server. A thread of its own keeps the session and
/// receives; frames are taken from the command and from the data socket, and only from the server's
/// address. Tracking is lost while the server does not see the body. Has no end.
class NatNetTracker final : public Tracker {
 public:
  /// Waits until frames come, for `patience` (s) at each stage. `spec` is of kind kNatnet. `start`:
  /// see PoseFeed. Throws
  /// InputError with one line: which socket is silent and why that may be, a version that is not
  /// known, or which bodies there are.
  explicit NatNetTracker(const TrackerSpec& spec, double patience = kNatNetPatience,
                         const Pose& start = {});
  ~NatNetTracker() override;
  NatNetTracker(const NatNetTracker&) = delete;
  NatNetTracker& operator=(const NatNetTracker&) = delete;

  [[nodiscard]] TrackedPose sample(double time) override;
  [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }
  [[nodiscard]] std::optional<std::string> take_message() override;

 private:
  void connect(double patience);
  void serve();
  /// Receives what there is, or waits a moment for it, and sends what is due.
  void exchange();
  void receive_from(UdpSocket& socket);
  void open_data_socket();
  [[nodiscard]] std::string obstacle(NatNetStage stage) const;

  TrackerSpec spec_;
  Endpoint server_;
  std::uint32_t interface_;  ///< address of this machine that reaches the server
  UdpSocket command_;
  std::optional<UdpSocket> data_;
  std::optional<Endpoint> data_place_;     ///< group or own address, and port, of data_
  std::optional<std::uint32_t> stranger_;  ///< sent frames, but is not the server
  PoseFeed feed_;
  NatNetSession session_;
  std::vector<std::uint8_t> buffer_;
  std::atomic<bool> ending_{false};
  std::atomic<NatNetStage> stage_{NatNetStage::kStreaming};
  bool told_streaming_ = true;  ///< what take_message() said last
  std::thread thread_;
};

}  // namespace softfinger
