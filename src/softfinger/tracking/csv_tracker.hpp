#pragma once

#include <filesystem>
#include <vector>

#include "softfinger/tracking/tracker.hpp"

namespace softfinger {

/// One row of a pose file.
struct PoseSample {
  double time = 0.0;                ///< s, from the start of the run
  Vector3 p_WFt = Vector3::Zero();  ///< origin of Ft in W, m
  Eigen::Quaterniond rotation_WFt = Eigen::Quaterniond::Identity();
};

/// Reads a CSV file of tracked poses with the header `time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz`.
/// Throws InputError with file, line and column: a wrong header, a row that is not eight finite
/// numbers, times that do not increase, a quaternion whose norm is off by more than 1 %, no rows.
[[nodiscard]] std::vector<PoseSample> read_pose_csv(const std::filesystem::path& file);

/// Timestamped poses, resampled by time: linear in position, spherically linear in rotation. Where
/// rows lie more than kLostAfter apart tracking is lost: the earlier pose is held, valid for
/// kLostAfter and then not until the next row. Not valid before the first row. Ends with the last.
class CsvTracker final : public Tracker {
 public:
  /// At least one row, times strictly increasing.
  explicit CsvTracker(std::vector<PoseSample> rows);
  [[nodiscard]] TrackedPose sample(double time) override;
  [[nodiscard]] std::optional<double> end_time() const override;

 private:
  std::vector<PoseSample> rows_;
};

}  // namespace softfinger
