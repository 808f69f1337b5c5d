#include <algorithm>
#include <array>
#include <cmath>

#include "softfinger/tracking/natnet/natnet_encoding.hpp"
#include "softfinger/tracking/natnet/natnet_session.hpp"

// A server that says anything at all: nothing is read past the end, and a pose is one or is not
// there. The first byte chooses the version, the rest are datagrams, each after its length.
extern "C" int fuzz_natnet(const std::uint8_t* data, std::size_t size) {
  using namespace softfinger;
  if (size == 0) return 0;
  constexpr std::array<NatNetVersion, 5> kVersions{{{3, 0}, {3, 1}, {4, 0}, {4, 1}, {4, 2}}};
  const NatNetVersion version = kVersions[data[0] % kVersions.size()];
  PoseFeed feed;
  NatNetSession session({.kind = TrackerKind::kNatnet, .body = "index"}, feed);
  double now = 100.0;
  session.receive(encode_natnet_server({.version = version, .ticks_per_second = 1000}), now);
  session.receive(
      encode_natnet_models(std::array<NatNetBody, 1>{NatNetBody{7, "index"}}, version, false), now);
  for (std::size_t i = 1; i + 1 < size;) {
    const std::size_t length =
        std::min<std::size_t>(size - i - 2, data[i] | std::size_t{data[i + 1]} << 8);
    i += 2;
    session.receive({data + i, length}, now);
    session.send_due(now, [](std::span<const std::uint8_t>) {});
    i += length;
    now += 0.05;
    const TrackedPose pose = feed.sample(now - 100.0, now);
    if (!pose.X_WFt.translation.allFinite() || !pose.X_WFt.rotation.allFinite() ||
        std::abs(pose.X_WFt.rotation.determinant() - 1.0) > 1e-6 ||
        pose.time > now - 100.0 + 1e-9) {
      __builtin_trap();
    }
    (void)session.stage(now);
  }
  return 0;
}
