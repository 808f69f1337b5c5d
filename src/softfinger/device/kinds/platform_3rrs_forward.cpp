#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "softfinger/device/kinds/platform_3rrs.hpp"
#include "softfinger/device/kinds/platform_3rrs_legs.hpp"

namespace softfinger {

// Newton on the closure of the three couplers, |platform joint - knee|^2 = b^2, from the q given.
// True where it ends at a configuration whose inverse kinematics gives the joints back.
bool Platform3rrs::newton_forward(const JointAngles& joints, Configuration& q) const {
  const double a = geometry_.crank;
  const double b = geometry_.coupler;
  for (int iteration = 0; iteration < 40; ++iteration) {
    const Tilt tilt(q[0], q[1]);
    Vector3 residual;
    Matrix3 jacobian;
    for (int leg = 0; leg < 3; ++leg) {
      const LegPosture posture = leg_posture(geometry_, tilt, q[2], leg);
      const double dx = posture.x.v - a * std::cos(joints[leg]);
      const double dy = posture.y.v - a * std::sin(joints[leg]);
      residual[leg] = 0.5 * (dx * dx + dy * dy - b * b);
      jacobian.row(leg) << dx * posture.x.p + dy * posture.y.p, dx * posture.x.r + dy * posture.y.r,
          -dy;
    }
    Vector3 step = -jacobian.partialPivLu().solve(residual);
    if (!step.allFinite()) return false;
    // Long steps leave the assembly mode: at most 0.3 rad and half a crank at a time.
    const double length =
        std::max({std::abs(step[0]) / 0.3, std::abs(step[1]) / 0.3, std::abs(step[2]) / (0.5 * a)});
    if (length > 1.0) step /= length;
    q[0] += step[0];
    q[1] += step[1];
    q[2] += step[2];
    if (std::hypot(q[0], q[1]) > 1.5) return false;
    if (length < 1e-13) break;
  }
  JointAngles back;
  if (!inverse_kinematics(q, back)) return false;
  for (int leg = 0; leg < 3; ++leg) {
    if (!(std::abs(std::remainder(back[leg] - joints[leg], 2.0 * std::numbers::pi)) < 1e-8))
      return false;
  }
  return true;
}

bool Platform3rrs::forward_kinematics(const JointAngles& joints, Configuration& q) const {
  if (joints.size() != 3 || !joints.allFinite()) return false;
  q = home();
  if (newton_forward(joints, q) && reachable(q)) return true;

  // Follow the solution from home's joints to the ones asked for: stays in home's assembly mode as
  // long as it meets no singularity on the way.
  JointAngles from;
  if (inverse_kinematics(home(), from)) {
    constexpr int kPieces = 24;
    q = home();
    bool following = true;
    for (int piece = 1; piece <= kPieces && following; ++piece) {
      const JointAngles between = from + (joints - from) * (static_cast<double>(piece) / kPieces);
      following = newton_forward(between, q) && singularity_ratio(q) > 0.0;
    }
    // Followed to the end, this is the solution of home's assembly mode: in the workspace or not.
    if (following) return reachable(q);
  }

  // Starts all over the workspace.
  const double reach = geometry_.crank + geometry_.coupler;
  for (int level = -4; level <= 4; ++level) {
    for (int ring = 0; ring <= 2; ++ring) {
      for (int spoke = 0; spoke < (ring == 0 ? 1 : 8); ++spoke) {
        const double tilt = 0.45 * ring * geometry_.max_tilt;
        const double azimuth = 0.25 * spoke * std::numbers::pi;
        q = home();
        q[0] = tilt * std::cos(azimuth);
        q[1] = tilt * std::sin(azimuth);
        q[2] += level * reach / 8.0;
        if (newton_forward(joints, q) && reachable(q)) return true;
      }
    }
  }
  return false;
}

}  // namespace softfinger
