#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// A tracker whose poses come now and then, 60 or 120 times a second, and are wanted in between: it
/// gives poses on the straight way between the two that were true around a moment a little ago, so
/// that an even motion stays even. That moment stays behind by as much as the next pose was late to
/// come at most in the last one to two seconds, one interval of the sender where it is regular, but
/// never behind the newest pose by more than kMostDelay. It never passes the newest pose: where the
/// next one is later still, the newest is held. Lost tracking is told at once, with the last pose
/// held; what comes after starts anew. Rules on times of poses alone, so that the same poses give
/// the same bits.
class InterpolatedTracker final : public Tracker {
 public:
  explicit InterpolatedTracker(std::unique_ptr<Tracker> source) : source_(std::move(source)) {}

  /// `time` and `arrival` of what is returned are of the pose in between.
  [[nodiscard]] TrackedPose sample(double time) override;
  [[nodiscard]] std::optional<double> end_time() const override { return source_->end_time(); }
  [[nodiscard]] std::optional<std::string> take_message() override {
    return source_->take_message();
  }

  static constexpr double kMostDelay = 0.04;  ///< s

 private:
  void take(const TrackedPose& pose, double time);
  [[nodiscard]] TrackedPose between(double moment) const;
  [[nodiscard]] const TrackedPose& seen(std::size_t back) const {
    return seen_[(newest_ + seen_.size() - back) % seen_.size()];
  }

  std::unique_ptr<Tracker> source_;
  std::array<TrackedPose, 64> seen_;  ///< a ring
  std::size_t newest_ = 0;
  std::size_t count_ = 0;
  bool known_ = false;  ///< there was a valid pose
  TrackedPose given_;   ///< at the last sample()
  double time_ = 0.0;   ///< s, of the last sample()
  double delay_ = 0.0;  ///< s, from the moment of the pose given to now
  // Greatest delays that were needed in this second and in the one before.
  double window_began_ = 0.0;
  double needed_ = 0.0;
  double needed_before_ = 0.0;
};

}  // namespace softfinger
