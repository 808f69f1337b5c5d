#include <cmath>

#include "softfinger/tracking/stream/osc_pose.hpp"
#include "softfinger/tracking/stream/pose_datagram.hpp"

// What the trackers udp and osc take for a pose is one.
extern "C" int fuzz_pose_message(const std::uint8_t* data, std::size_t size) {
  using namespace softfinger;
  for (const auto decode : {decode_pose_datagram, decode_osc_pose}) {
    const auto message = decode({data, size});
    if (!message || !message->valid) continue;
    const Pose& pose = message->X_WFt;
    if (!(pose.translation.cwiseAbs().maxCoeff() <= 100.0) ||
        !(std::abs(pose.rotation.determinant() - 1.0) < 1e-6)) {
      __builtin_trap();
    }
  }
  return 0;
}
