#pragma once

#include <cstdint>
#include <optional>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// What a datagram says of a tracked body.
struct PoseMessage {
  Pose X_WFt;                             ///< meaningless unless valid
  bool valid = true;                      ///< false: the sender itself does not see the body
  std::optional<std::uint32_t> sequence;  ///< counted by the sender
  std::optional<double> time;             ///< s on the sender's clock: when the pose was true
};

/// The pose of position (m) and quaternion, which came from outside; none where a number is not
/// finite, the position is over 100 m away or the quaternion's norm is off by more than 1 %.
[[nodiscard]] std::optional<Pose> pose_from_outside(const Vector3& position,
                                                    const Eigen::Quaterniond& rotation);

}  // namespace softfinger
