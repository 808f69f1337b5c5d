#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "softfinger/tracking/natnet/natnet_clock.hpp"
#include "softfinger/tracking/natnet/natnet_protocol.hpp"
#include "softfinger/tracking/stream/pose_feed.hpp"
#include "softfinger/tracking/stream/sequence_gate.hpp"
#include "softfinger/tracking/tracker_spec.hpp"

namespace softfinger {

/// How far a client has come with its server.
enum class NatNetStage {
  kNoAnswer,      ///< the command socket is silent
  kOtherVersion,  ///< the server speaks no version that is known here
  kNoModels,      ///< it answers, but does not say what it tracks
  kNoSuchBody,    ///< it tracks no body of that name
  kNoFrames,      ///< the data socket is silent
  kFramesUnread,  ///< frames come, but cannot be read
  kStreaming,
};

/// What a client says to one NatNet server and makes of what it hears, without its sockets: finds
/// out version and models, keeps the clocks together, and feeds the newest pose of one rigid body.
/// Times are s on the monotonic clock. One thread.
class NatNetSession {
 public:
  using Send = std::function<void(std::span<const std::uint8_t>)>;

  /// `spec` of kind kNatnet; `feed` outlives the session.
  NatNetSession(const TrackerSpec& spec, PoseFeed& feed) : spec_(spec), feed_(feed) {}

  /// A datagram of the server, from whichever socket. Bytes that are no NatNet change nothing.
  void receive(std::span<const std::uint8_t> datagram, double now);
  /// Sends to the server's command socket what is due.
  void send_due(double now, const Send& send);

  [[nodiscard]] NatNetStage stage(double now) const;
  /// Null until the server has answered.
  [[nodiscard]] const NatNetServer* server() const { return server_ ? &*server_ : nullptr; }
  /// Whether frames come by multicast, as asked for or else as the server says.
  [[nodiscard]] bool multicast() const;
  /// What the server tracks.
  [[nodiscard]] const std::vector<NatNetBody>& bodies() const { return bodies_; }

 private:
  void take_server(const NatNetServer& server);
  void take_models(std::vector<NatNetBody> bodies, double now);
  void take_frame(std::span<const std::uint8_t> payload, double now);
  [[nodiscard]] bool version_is_known() const;

  TrackerSpec spec_;
  PoseFeed& feed_;
  NatNetClock clock_;
  SequenceGate gate_;
  std::optional<NatNetServer> server_;
  NatNetVersion version_;  ///< of frames and models
  std::vector<NatNetBody> bodies_;
  std::optional<std::int32_t> body_;
  bool models_known_ = false;
  bool ask_server_ = true;

  static constexpr double kNever = -1e9;
  double answered_ = kNever;  ///< when the command socket was last heard
  double models_came_ = kNever;
  double frame_came_ = kNever;   ///< the last that could be read
  double unread_came_ = kNever;  ///< the last that could not
  double connect_due_ = kNever;
  double version_due_ = kNever;
  double models_due_ = kNever;
  double echo_due_ = kNever;
  double keep_alive_due_ = kNever;
  int echoes_ = 0;
};

}  // namespace softfinger
