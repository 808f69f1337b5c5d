#pragma once

#include "softfinger/geometry/pose.hpp"
#include "softfinger/wearer/press_plan.hpp"

namespace softfinger {

/// Where the skin is that a device is about to touch, as far as the touches before it tell: off the
/// model's skin by a plane over pitch and roll, and each by something of its own.
class ExpectedTouch {
 public:
  ExpectedTouch();

  /// The device touched the skin at `touched`, m, as PlannedPress::touch is of the model's.
  void learn(const PlannedPress& press, double touched);

  struct Place {
    double touch, deviation;  ///< as PlannedPress::touch, and its standard deviation, m
  };
  [[nodiscard]] Place of(const PlannedPress& press) const;

 private:
  // Normal equations of the plane.
  Matrix3 weights_ = Matrix3::Zero();
  Vector3 offsets_ = Vector3::Zero();
};

}  // namespace softfinger
