#pragma once

#include <memory>
#include <utility>

#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// A tracker of a body that is fixed to the finger, a plate on the nail or a joint of a headset's
/// hand: X_WFt = X_WBody X_BodyFt.
class RegisteredTracker final : public Tracker {
 public:
  RegisteredTracker(std::unique_ptr<Tracker> body, const Pose& X_BodyFt)
      : body_(std::move(body)), X_BodyFt_(X_BodyFt) {}

  [[nodiscard]] TrackedPose sample(double time) override {
    TrackedPose pose = body_->sample(time);
    pose.X_WFt = pose.X_WFt * X_BodyFt_;
    return pose;
  }
  [[nodiscard]] std::optional<double> end_time() const override { return body_->end_time(); }
  [[nodiscard]] std::optional<std::string> take_message() override { return body_->take_message(); }

 private:
  std::unique_ptr<Tracker> body_;
  Pose X_BodyFt_;
};

}  // namespace softfinger
