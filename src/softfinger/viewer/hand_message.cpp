#include "softfinger/viewer/hand_message.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

static_assert(std::endian::native == std::endian::little, "messages are read as they lie");

constexpr std::uint32_t kHandMagic = 0x58484653;
constexpr std::uint32_t kTracked = 1;
constexpr std::uint32_t kLeftHand = 2;
constexpr std::size_t kHandHeaderBytes = 16;
constexpr std::size_t kJointBytes = 8 * sizeof(float);
constexpr double kLongestTime = 100.0 * 366.0 * 86400.0;  // s
constexpr float kFarthestJoint = 10.0F;                   // m, of a coordinate
constexpr float kLargestRadius = 0.1F;                    // m
constexpr float kQuaternionTolerance = 0.01F;             // of its length

template <typename T>
T take(std::string_view& message) {
  T value;
  std::memcpy(&value, message.data(), sizeof value);
  message.remove_prefix(sizeof value);
  return value;
}

std::optional<XrJoint> take_joint(std::string_view& message) {
  XrJoint joint;
  for (float& coordinate : joint.position) {
    coordinate = take<float>(message);
    if (!(std::abs(coordinate) <= kFarthestJoint)) return {};
  }
  for (float& component : joint.rotation.coeffs()) component = take<float>(message);
  if (!(std::abs(joint.rotation.norm() - 1.0F) <= kQuaternionTolerance)) return {};
  joint.rotation.normalize();
  joint.radius = take<float>(message);
  if (!(joint.radius >= 0.0F && joint.radius <= kLargestRadius)) return {};
  return joint;
}

}  // namespace

std::optional<XrHand> parse_hand_message(std::string_view message) {
  if (message.size() < kHandHeaderBytes) return {};
  if (take<std::uint32_t>(message) != kHandMagic) return {};
  const auto flags = take<std::uint32_t>(message);
  if ((flags & ~(kTracked | kLeftHand)) != 0) return {};
  XrHand hand;
  hand.tracked = (flags & kTracked) != 0;
  hand.side = (flags & kLeftHand) != 0 ? HandSide::kLeft : HandSide::kRight;
  hand.time = take<double>(message) * ms;
  if (!(hand.time >= 0.0 && hand.time <= kLongestTime)) return {};
  if (message.size() != (hand.tracked ? kXrJointCount * kJointBytes : 0)) return {};
  if (!hand.tracked) return hand;
  for (XrJoint& joint : hand.joints) {
    const auto next = take_joint(message);
    if (!next) return {};
    joint = *next;
  }
  return hand;
}

}  // namespace softfinger
