#include "softfinger/c_interface/frames.hpp"

#include <cmath>

#include "softfinger/c_interface/answers.hpp"

namespace softfinger {
namespace {

bool is_near_one(double norm) { return std::abs(norm - 1.0) <= kRotationTolerance; }

/// `from` and `to` of one engine are of the sizes they say, and the pose is one.
template <typename From, typename To>
bool can_convert(const From* from, const To* to) {
  return from != nullptr && to != nullptr && from->size >= sizeof(From) && to->size >= sizeof(To);
}

bool is_near_origin(const Vector3& position) {
  return position.cwiseAbs().maxCoeff() <= kFarthest && position.allFinite();
}

}  // namespace

std::optional<Pose> pose_of(const sf_pose& pose) {
  const auto& q = pose.quaternion_wxyz;
  const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  const Vector3 position(pose.position_m);
  if (!is_near_origin(position) || !is_near_one(rotation.norm())) return std::nullopt;
  return Pose{rotation.normalized().toRotationMatrix(), position};
}

std::optional<Pose> pose_of(const double (&matrix)[16]) {
  using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Eigen::Map<const RowMajor> X(matrix);
  if (!X.allFinite() || X.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) return std::nullopt;
  const Matrix3 rotation = X.topLeftCorner<3, 3>();
  const Matrix3 off = rotation.transpose() * rotation - Matrix3::Identity();
  if (!(off.cwiseAbs().maxCoeff() <= kRotationTolerance) || rotation.determinant() < 0.0) {
    return std::nullopt;
  }
  const Vector3 position = X.topRightCorner<3, 1>();
  if (!is_near_origin(position)) return std::nullopt;
  return Pose{rotation, position};
}

sf_pose c_pose(const Pose& pose) {
  const Eigen::Quaterniond q(pose.rotation);
  const Vector3& p = pose.translation;
  return {sizeof(sf_pose), {p.x(), p.y(), p.z()}, {q.w(), q.x(), q.y(), q.z()}};
}

}  // namespace softfinger

// A map M of the axes that mirrors turns a rotation R into M R M^-1, whose quaternion is that of R
// with its vector part v turned into -M v.

sf_status sf_pose_to_unity(const sf_pose* pose, sf_unity_pose* out) {
  if (!softfinger::can_convert(pose, out)) return SF_BAD_INPUT;
  const auto& p = pose->position_m;
  const auto& q = pose->quaternion_wxyz;
  softfinger::hand_out({sizeof *out, {-p[1], p[2], p[0]}, {q[2], -q[3], -q[1], q[0]}}, out);
  return SF_DONE;
}

sf_status sf_pose_from_unity(const sf_unity_pose* pose, sf_pose* out) {
  if (!softfinger::can_convert(pose, out)) return SF_BAD_INPUT;
  const auto& p = pose->position_m;
  const auto& q = pose->quaternion_xyzw;
  softfinger::hand_out({sizeof *out, {p[2], -p[0], p[1]}, {q[3], -q[2], q[0], -q[1]}}, out);
  return SF_DONE;
}

sf_status sf_pose_to_unreal(const sf_pose* pose, sf_unreal_pose* out) {
  if (!softfinger::can_convert(pose, out)) return SF_BAD_INPUT;
  const auto& p = pose->position_m;
  const auto& q = pose->quaternion_wxyz;
  softfinger::hand_out(
      {sizeof *out, {100.0 * p[0], -100.0 * p[1], 100.0 * p[2]}, {-q[1], q[2], -q[3], q[0]}}, out);
  return SF_DONE;
}

sf_status sf_pose_from_unreal(const sf_unreal_pose* pose, sf_pose* out) {
  if (!softfinger::can_convert(pose, out)) return SF_BAD_INPUT;
  const auto& p = pose->position_cm;
  const auto& q = pose->quaternion_xyzw;
  softfinger::hand_out(
      {sizeof *out, {p[0] / 100.0, -p[1] / 100.0, p[2] / 100.0}, {q[3], -q[0], q[1], -q[2]}}, out);
  return SF_DONE;
}
