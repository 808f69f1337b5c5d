#include <cmath>
#include <cstdint>
#include <string_view>

#include "softfinger/tracking/webxr_tracker.hpp"
#include "softfinger/viewer/hand_message.hpp"

// Whatever a page sends: it is refused, or a hand whose fingers have finite poses that are rigid.
extern "C" int fuzz_hand_message(const std::uint8_t* data, std::size_t size) {
  using namespace softfinger;
  const std::string_view message(reinterpret_cast<const char*>(data), size);
  const auto hand = parse_hand_message(message);
  if (!hand) return 0;
  if (!std::isfinite(hand->time)) __builtin_trap();
  for (const HandFinger finger : {HandFinger::kThumb, HandFinger::kIndex, HandFinger::kMiddle,
                                  HandFinger::kRing, HandFinger::kPinky}) {
    WebXrTracker tracker({}, hand->side, finger);
    tracker.offer(*hand);
    const TrackedPose pose = tracker.sample(1.0);
    const Matrix3& R = pose.X_WFt.rotation;
    const bool rigid = (R.transpose() * R - Matrix3::Identity()).norm() < 1e-9;
    if (pose.valid != hand->tracked || !rigid || !(pose.X_WFt.translation.norm() < 20.0)) {
      __builtin_trap();
    }
  }
  return 0;
}
