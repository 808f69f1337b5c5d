#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <random>

#include "softfinger/base/units.hpp"
#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// How a tracking system sees a motion.
struct TrackingQuality {
  double rate = 120.0;     ///< poses a second, Hz; above 0
  double age = 15.0 * ms;  ///< of a pose when it arrives, s
  // Standard deviations about each axis.
  double noise = 0.1 * mm;        ///< m
  double turn_noise = 0.2 * deg;  ///< rad
  std::uint64_t seed = 1;         ///< of the noise
};

/// A known motion as such a system sees it, in simulated time: to try what is made of its poses
/// against the truth.
class DegradedTracker final : public Tracker {
 public:
  using Motion = std::function<Pose(double time)>;
  DegradedTracker(Motion motion, const TrackingQuality& quality);

  /// Not valid before the first pose has come.
  [[nodiscard]] TrackedPose sample(double time) override;
  [[nodiscard]] std::optional<double> end_time() const override { return std::nullopt; }

 private:
  Motion motion_;
  TrackingQuality quality_;
  TrackedPose pose_;
  std::mt19937_64 random_;
};

}  // namespace softfinger
