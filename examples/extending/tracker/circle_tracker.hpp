#pragma once

#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// A fingertip that goes round a circle in a plane parallel to the world's xy, pad down, once a
/// period: for exploring an object the same way each time.
class CircleTracker final : public Tracker {
 public:
  /// centre_W: of Ft's way, m; radius in m, >= 0; period in s, > 0; turns: after which it ends, >
  /// 0. Throws InputError for others.
  CircleTracker(const Vector3& centre_W, double radius, double period, double turns);

  [[nodiscard]] TrackedPose sample(double time) override;
  [[nodiscard]] std::optional<double> end_time() const override { return turns_ * period_; }

 private:
  Vector3 centre_W_;
  double radius_, period_, turns_;
};

}  // namespace softfinger
