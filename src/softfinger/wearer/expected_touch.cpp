#include "softfinger/wearer/expected_touch.hpp"

#include <cmath>

#include "softfinger/base/units.hpp"

namespace softfinger {
namespace {

// How far the skin may be from where the model's is: of all tilts alike, m; by pitch and by roll, m
// by rad; of each, m.
constexpr double kOffsets[] = {1.5 * mm, 2.0 * mm, 2.0 * mm};
constexpr double kOwnOffset = 0.35 * mm;

Vector3 plane_at(const PlannedPress& press) { return {1.0, press.pitch, press.roll}; }

}  // namespace

ExpectedTouch::ExpectedTouch() {
  for (int i = 0; i < 3; ++i) weights_(i, i) = 1.0 / (kOffsets[i] * kOffsets[i]);
}

void ExpectedTouch::learn(const PlannedPress& press, double touched) {
  constexpr double kWeight = 1.0 / (kOwnOffset * kOwnOffset);
  const Vector3 by = plane_at(press);
  weights_ += kWeight * by * by.transpose();
  offsets_ += kWeight * (touched - press.touch) * by;
}

ExpectedTouch::Place ExpectedTouch::of(const PlannedPress& press) const {
  const Vector3 by = plane_at(press);
  const Matrix3 covariance = weights_.inverse();
  return {press.touch + by.dot(covariance * offsets_),
          std::sqrt(by.dot(covariance * by) + kOwnOffset * kOwnOffset)};
}

}  // namespace softfinger
