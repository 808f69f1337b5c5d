#include "softfinger/tracking/stream/pose_message.hpp"

#include <cmath>

namespace softfinger {
namespace {

constexpr double kFarthest = 100.0;  // m
constexpr double kNormRounding = 0.01;

}  // namespace

std::optional<Pose> pose_from_outside(const Vector3& position, const Eigen::Quaterniond& rotation) {
  // Written so that what is no number fails.
  if (!(position.cwiseAbs().maxCoeff() <= kFarthest) || !position.allFinite()) return std::nullopt;
  if (!(std::abs(rotation.norm() - 1.0) <= kNormRounding)) return std::nullopt;
  return Pose{rotation.normalized().toRotationMatrix(), position};
}

}  // namespace softfinger
