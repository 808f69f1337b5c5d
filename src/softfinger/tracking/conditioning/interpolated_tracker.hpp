#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// A tracker whose poses come now and then, 60 or 120 times a second, and are wanted in between: it
/// gives poses on the straight way between the two that were true around a moment a little ago, so
/// that an even motion stays even. That moment stays behind by as much as the next pose was late to
/// come at most in the last one to two seconds: one interval of the sender where it is regular,
/// and what ways and time stamps vary beyond that; by two intervals and kAllowance at most, and
/// never by more than kMostDelay, beside the age that poses have when they come. It never passes
/// the newest pose: where the next one is later still, the newest is held, and what was missed
/// played at kMostSpeedUp. Poses whose time stamps crowd are taken to be farther apart, since hands
/// are more even than clocks: by kLeastShare of an interval, as far as kMostShift allows. Lost
/// tracking is told at once, with the last pose held; what comes after starts anew. Rules on times
/// of poses alone, so that the same poses give the same bits.
class InterpolatedTracker final : public Tracker {
 public:
  explicit InterpolatedTracker(std::unique_ptr<Tracker> source) : source_(std::move(source)) {}

  /// `time` and `arrival` of what is returned are of the pose in between.
  [[nodiscard]] TrackedPose sample(double time) override;
  [[nodiscard]] std::optional<double> end_time() const override { return source_->end_time(); }
  [[nodiscard]] std::optional<std::string> take_message() override {
    return source_->take_message();
  }

  static constexpr double kMostDelay = 0.05;   ///< s
  static constexpr double kAllowance = 0.015;  ///< s
  static constexpr double kMostSpeedUp = 3.0;
  /// Of the sender's interval, the least that lies between two poses.
  static constexpr double kLeastShare = 0.6;
  static constexpr double kMostShift = 0.01;  ///< s, of a time stamp

 private:
  /// A pose, and the time that its sender gave it: its own is moved where that is uneven.
  struct Seen {
    TrackedPose pose;
    double stamp = 0.0;
  };
  /// Of the poses that came in a second.
  struct Arrivals {
    double needed = 0.0;  ///< s, the greatest delay that one before the next needed
    double least_age = std::numeric_limits<double>::infinity();  ///< s, when they came
  };
  void take(const TrackedPose& pose, double time);
  void begin_anew(const TrackedPose& pose, double time);
  void note_arrival(const TrackedPose& pose, double time);
  void adapt_delay(double elapsed);
  [[nodiscard]] double median_interval() const;
  [[nodiscard]] double even_time(double stamp) const;
  [[nodiscard]] TrackedPose between(double moment) const;
  [[nodiscard]] const Seen& seen(std::size_t back) const {
    return seen_[(newest_ + seen_.size() - back) % seen_.size()];
  }

  std::unique_ptr<Tracker> source_;
  std::array<Seen, 64> seen_;  ///< a ring
  std::size_t newest_ = 0;
  std::size_t count_ = 0;
  bool known_ = false;     ///< there was a valid pose
  TrackedPose given_;      ///< at the last sample()
  double time_ = 0.0;      ///< s, of the last sample()
  double moment_ = 0.0;    ///< s, of the pose given
  double delay_ = 0.0;     ///< s, that it is to be behind
  double interval_ = 0.0;  ///< s, of the sender; 0: not known
  Arrivals this_second_, last_second_;
  double second_began_ = 0.0;
};

}  // namespace softfinger
