#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "softfinger/tracking/registration/registration.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// Guides through the postures of a registration. Each is taken by itself once the body has been
/// still for a second at an inclination unlike the last one's, so that nobody needs a free hand.
/// Deterministic; allocates nothing.
class RegistrationProcedure {
 public:
  /// The pad comes twice: a body that slipped on the finger meanwhile shows.
  static constexpr std::array kOrder{Posture::kPad, Posture::kLeftSide, Posture::kRightSide,
                                     Posture::kTip, Posture::kPad};
  static constexpr double kStillTime = 1.0;  ///< s

  /// The newest X_WBody, in order of time; one that is not valid, or 200 ms after the last, starts
  /// the second anew, and one of the same time as the last is left out.
  void take(const TrackedPose& body);

  [[nodiscard]] bool done() const { return count_ == kOrder.size(); }
  /// What to hold next; not where done.
  [[nodiscard]] Posture wanted() const { return kOrder.at(count_); }
  /// Part of the second that the body has been still, 0 to 1.
  [[nodiscard]] double progress() const { return progress_; }
  [[nodiscard]] std::span<const PostureCapture> captures() const {
    return std::span(captures_).first(count_);
  }

 private:
  void begin(const TrackedPose& body);
  [[nodiscard]] bool is_still(const Pose& X_WBody) const;
  [[nodiscard]] bool is_new_posture() const;

  std::array<PostureCapture, kOrder.size()> captures_;
  std::size_t count_ = 0;
  double progress_ = 0.0;
  bool known_ = false;                ///< a pose came, and tracking was not lost since
  double time_ = 0.0;                 ///< s, of the newest pose
  double still_since_ = 0.0;          ///< s
  Pose first_;                        ///< when it came to rest
  Vector3 up_sum_ = Vector3::Zero();  ///< since then
  double height_sum_ = 0.0;
  double taken_ = 0.0;  ///< number of poses in the sums
};

}  // namespace softfinger
