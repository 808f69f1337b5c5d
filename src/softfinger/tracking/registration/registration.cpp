#include "softfinger/tracking/registration/registration.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kMostTurn = 20.0 * deg;
constexpr double kMostLift = 3.0 * mm;
constexpr double kFarthestBody = 300.0 * mm;
constexpr double kLeastBreadth = 8.0 * mm;
constexpr double kGreatestBreadth = 30.0 * mm;

void check_complete(std::span<const PostureCapture> captures) {
  for (const PostureRow& posture : kPostures) {
    if (std::ranges::find(captures, posture.value, &PostureCapture::posture) == captures.end()) {
      throw InputError(fmt::format(
          "registration: posture '{}' was not captured; rest the fingertip so and hold still",
          posture.name));
    }
  }
}

/// Kabsch 1976: R of least sum |up_Body - R up_F|^2, det R = 1.
Matrix3 rotation_of(std::span<const PostureCapture> captures) {
  Matrix3 sum = Matrix3::Zero();
  for (const PostureCapture& capture : captures) {
    sum += capture.up_Body * up_in_finger(capture.posture).transpose();
  }
  const Eigen::JacobiSVD<Matrix3> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double handedness = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return svd.matrixU() * Vector3(1.0, 1.0, handedness < 0.0 ? -1.0 : 1.0).asDiagonal() *
         svd.matrixV().transpose();
}

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// How far the skin reaches from F's origin in a direction, m.
double reach(std::span<const Vector3> skin_F, const Vector3& direction_F) {
  double farthest = -std::numeric_limits<double>::infinity();
  for (const Vector3& p : skin_F) farthest = std::max(farthest, p.dot(direction_F));
  return farthest;
}

}  // namespace

Vector3 up_in_finger(Posture posture) {
  switch (posture) {
    case Posture::kPad:
      return Vector3::UnitZ();
    case Posture::kLeftSide:
      return -Vector3::UnitY();
    case Posture::kRightSide:
      return Vector3::UnitY();
    case Posture::kTip:
      break;
  }
  return -Vector3::UnitX();
}

Registration register_finger(std::span<const PostureCapture> captures,
                             std::span<const Vector3> skin_F, std::optional<double> table_height,
                             bool size_known) {
  check_complete(captures);
  if (!table_height && !size_known) {
    throw InputError(
        "registration: neither the table's height nor the finger's size is known; give one");
  }
  Registration found;
  found.X_BodyFt.rotation = rotation_of(captures);

  const auto turned = [&](const PostureCapture& capture) {
    return angle_between(capture.up_Body, found.X_BodyFt.rotation * up_in_finger(capture.posture));
  };
  const PostureCapture& most_turned = *std::ranges::max_element(captures, {}, turned);
  found.turn_residual = turned(most_turned);
  if (!(found.turn_residual <= kMostTurn)) {
    throw InputError(fmt::format(
        "registration: posture '{}' is {:.0f} degrees off from what the others say; do all of them "
        "again in the order asked for, each side flat on the table",
        name_of(most_turned.posture), found.turn_residual / deg));
  }

  // Columns: p, then the table's height, then the scale.
  const Eigen::Index rows = static_cast<Eigen::Index>(captures.size());
  const Eigen::Index unknowns = 3 + (table_height ? 0 : 1) + (size_known ? 0 : 1);
  Eigen::MatrixXd matrix(rows, unknowns);
  Eigen::VectorXd right(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const PostureCapture& capture = captures[static_cast<std::size_t>(i)];
    const double s = reach(skin_F, -(found.X_BodyFt.rotation.transpose() * capture.up_Body));
    matrix.row(i).head<3>() = capture.up_Body.transpose();
    right[i] = -capture.height + table_height.value_or(0.0) + (size_known ? s : 0.0);
    if (!table_height) matrix(i, 3) = -1.0;
    if (!size_known) matrix(i, unknowns - 1) = -s;
  }
  const Eigen::VectorXd solution = matrix.colPivHouseholderQr().solve(right);
  found.X_BodyFt.translation = solution.head<3>();
  found.table_height = table_height ? *table_height : solution[3];
  found.scale = size_known ? 1.0 : solution[unknowns - 1];

  const double breadth =
      found.scale * (reach(skin_F, Vector3::UnitY()) + reach(skin_F, -Vector3::UnitY()));
  if (!(breadth >= kLeastBreadth && breadth <= kGreatestBreadth)) {
    throw InputError(
        fmt::format("registration: a finger {:.1f} mm broad, expected {:g} to {:g} mm; check {}",
                    breadth / mm, kLeastBreadth / mm, kGreatestBreadth / mm,
                    size_known ? "the size given" : "the height given for the table"));
  }
  const Eigen::VectorXd lifts = (matrix * solution - right).cwiseAbs();
  Eigen::Index worst = 0;
  found.height_residual = lifts.maxCoeff(&worst);
  if (!(found.height_residual <= kMostLift)) {
    throw InputError(fmt::format(
        "registration: posture '{}' is {:.1f} mm off the table that the others rest on; do all of "
        "them again on one level table, the tracked body held fast on the finger",
        name_of(captures[static_cast<std::size_t>(worst)].posture), found.height_residual / mm));
  }
  const double distance = found.X_BodyFt.translation.norm();
  if (!(distance <= kFarthestBody)) {
    throw InputError(fmt::format(
        "registration: the tracked body would be {:.0f} mm from the finger, expected at most {:g} "
        "mm; check {}",
        distance / mm, kFarthestBody / mm,
        table_height ? "the height given for the table" : "that it is the body on this finger"));
  }
  return found;
}

}  // namespace softfinger
