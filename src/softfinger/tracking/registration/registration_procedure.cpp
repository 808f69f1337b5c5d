#include "softfinger/tracking/registration/registration_procedure.hpp"

#include <algorithm>
#include <cmath>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

constexpr double kStillDistance = 1.0 * mm;
constexpr double kStillTurn = 2.0 * deg;
/// Postures that follow each other are 90 or 180 degrees apart.
constexpr double kLeastInclination = 45.0 * deg;

Vector3 up_in_body(const Pose& X_WBody) { return X_WBody.rotation.row(2).transpose(); }

}  // namespace

void RegistrationProcedure::begin(const TrackedPose& body) {
  first_ = body.X_WFt;
  still_since_ = body.time;
  up_sum_.setZero();
  height_sum_ = 0.0;
  taken_ = 0.0;
}

bool RegistrationProcedure::is_still(const Pose& X_WBody) const {
  const Matrix3 turn = first_.rotation.transpose() * X_WBody.rotation;
  return (X_WBody.translation - first_.translation).norm() <= kStillDistance &&
         log_rotation(turn).norm() <= kStillTurn;
}

bool RegistrationProcedure::is_new_posture() const {
  if (count_ == 0) return true;
  const double cosine = captures_.at(count_ - 1).up_Body.dot(up_in_body(first_));
  return cosine < std::cos(kLeastInclination);
}

void RegistrationProcedure::take(const TrackedPose& body) {
  if (done()) return;
  if (!body.valid) {
    known_ = false;
    progress_ = 0.0;
    return;
  }
  if (known_ && body.time == time_) return;
  const double since_last = body.time - time_;
  const bool goes_on = known_ && since_last > 0.0 && since_last <= kLostAfter;
  time_ = body.time;
  known_ = true;
  if (!goes_on || !is_still(body.X_WFt)) begin(body);
  up_sum_ += up_in_body(body.X_WFt);
  height_sum_ += body.X_WFt.translation.z();
  taken_ += 1.0;
  progress_ = 0.0;
  if (!is_new_posture()) return;
  progress_ = std::min(1.0, (time_ - still_since_) / kStillTime);
  if (progress_ < 1.0) return;
  captures_.at(count_) = {kOrder.at(count_), up_sum_.normalized(), height_sum_ / taken_};
  ++count_;
  progress_ = 0.0;
  known_ = false;
}

}  // namespace softfinger
