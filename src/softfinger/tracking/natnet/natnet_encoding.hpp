#pragma once

#include <cstdint>
#include <span>

#include "softfinger/tracking/natnet/natnet_protocol.hpp"

namespace softfinger {

// What a NatNet server sends, for the emulator and for tests.

/// A rigid body in a frame.
struct NatNetBodyPose {
  std::int32_t id = 0;
  Pose X_KBody;  ///< translation in the server's unit of length
  bool tracked = true;
};

/// All of a frame that a client looks at.
struct NatNetFrameContent {
  std::int32_t number = 0;
  std::span<const NatNetBodyPose> bodies;
  double time = 0.0;               ///< s since the start of the server
  std::uint64_t mid_exposure = 0;  ///< ticks
  std::uint64_t received = 0;      ///< ticks
  std::uint64_t transmitted = 0;   ///< ticks
  bool models_changed = false;
  bool version_changed = false;
  double mean_error = 0.0;  ///< of every body
  /// One of everything else that the version knows: marker sets, skeletons, force plates, ...
  bool with_all_sections = false;
};

[[nodiscard]] NatNetDatagram encode_natnet_server(const NatNetServer& server);
/// `with_all_kinds`: descriptions of all other kinds of things too, before and after the bodies'.
[[nodiscard]] NatNetDatagram encode_natnet_models(std::span<const NatNetBody> bodies,
                                                  NatNetVersion version, bool with_all_kinds);
[[nodiscard]] NatNetDatagram encode_natnet_frame(const NatNetFrameContent& frame,
                                                 NatNetVersion version);
[[nodiscard]] NatNetDatagram encode_natnet_echo(const NatNetEcho& echo);
/// The answer to a kRequest: 0 for done, else an error.
[[nodiscard]] NatNetDatagram encode_natnet_response(std::int32_t result);

}  // namespace softfinger
