#pragma once

#include <limits>
#include <optional>
#include <string>

#include "softfinger/geometry/pose.hpp"

namespace softfinger {

/// Tracking is lost where no pose came for this long, s.
inline constexpr double kLostAfter = 0.2;
/// And by the clock on the wall, s, where the run's time stands still or is slow.
inline constexpr double kLostOnWallAfter = 0.4;

/// Where the real fingertip is. `valid` is false while tracking is lost; the pose is then the last
/// known one.
struct TrackedPose {
  double time = 0.0;  ///< s, on the run's clock: when the pose was true
  /// s, on the run's clock: when it reached this program; NaN: it came from nowhere, the tracker
  /// has them all.
  double arrival = std::numeric_limits<double>::quiet_NaN();
  Pose X_WFt;  ///< tracked distal phalanx Ft in the world W
  bool valid = false;
};

/// A source of tracked poses. sample() allocates nothing and takes no lock.
class Tracker {
 public:
  virtual ~Tracker() = default;
  /// The pose to use at run time `time` (s, from 0, never decreasing).
  [[nodiscard]] virtual TrackedPose sample(double time) = 0;
  /// When the run should end (s); empty if the source has no end.
  [[nodiscard]] virtual std::optional<double> end_time() const = 0;
  /// What a person should know while poses are sampled, one line, each told once; not from the
  /// thread that samples.
  [[nodiscard]] virtual std::optional<std::string> take_message() { return std::nullopt; }
};

}  // namespace softfinger
