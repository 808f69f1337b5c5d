#include "violent_motion.hpp"

#include <algorithm>
#include <utility>

#include "softfinger/base/units.hpp"

namespace softfinger {

namespace {

constexpr double kHold = 48.0 * ms;
constexpr double kLongestJump = 20.0 * mm;
constexpr double kLargestTurn = 45.0 * deg;
constexpr std::size_t kJumpsPerWaypoint = 40;

/// `vector`, shortened to `length` where it is longer.
Vector3 at_most(double length, const Vector3& vector) {
  return vector * std::min(1.0, length / std::max(vector.norm(), 1e-300));
}

}  // namespace

ViolentMotion::ViolentMotion(std::vector<Waypoint> around, std::uint64_t seed)
    : around_(std::move(around)), random_(seed), next_jump_(kHold), X_WFt_(around_.front().pose) {}

const Pose& ViolentMotion::sample(double time) {
  for (; time >= next_jump_; next_jump_ += kHold) jump();
  return X_WFt_;
}

void ViolentMotion::jump() {
  const Pose& centre = around_[(jumps_++ / kJumpsPerWaypoint) % around_.size()].pose;
  const Vector3 to = centre.translation + kLongestJump * in_ball();
  X_WFt_.translation += at_most(kLongestJump, to - X_WFt_.translation);
  const Matrix3 turn =
      exp_rotation(kLargestTurn * in_ball()) * centre.rotation * X_WFt_.rotation.transpose();
  X_WFt_.rotation = exp_rotation(at_most(kLargestTurn, log_rotation(turn))) * X_WFt_.rotation;
}

double ViolentMotion::uniform() { return static_cast<double>(random_() >> 11) * 0x1p-52 - 1.0; }

Vector3 ViolentMotion::in_ball() {
  for (;;) {
    const double x = uniform();
    const double y = uniform();
    const double z = uniform();
    if (const Vector3 point(x, y, z); point.squaredNorm() <= 1.0) return point;
  }
}

}  // namespace softfinger
