#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/base/histogram.hpp"
#include "softfinger/recording/record.hpp"
#include "softfinger/session/worn_device.hpp"

namespace softfinger {

/// Counts of small numbers, e.g. iterations; those from kMost on are one.
class CountHistogram {
 public:
  static constexpr std::size_t kMost = 255;

  void add(std::int64_t number);
  void merge(const CountHistogram& other);
  /// Least number that at least `percent` of those added do not exceed; 0 when nothing was added.
  [[nodiscard]] std::int64_t percentile(double percent) const;
  [[nodiscard]] std::int64_t max() const { return max_; }

 private:
  std::array<std::uint64_t, kMost + 1> counts_{};
  std::uint64_t total_ = 0;
  std::int64_t max_ = 0;
};

/// What a run measured of one finger, or of all together.
struct FingerSummary {
  Histogram step_cpu_time;   ///< s, simulation thread
  Histogram step_wall_time;  ///< s
  Histogram match_cpu_time;  ///< s, device thread
  Histogram latency;         ///< s, arrival of the pose used by the step to the formed command
  StageHistograms stages;    ///< s
  Histogram pose_age;        ///< s, at the end of each tracked step, of the pose that it used
  CountHistogram iterations;
  std::uint64_t unconverged_steps = 0;
  std::uint64_t commands_sent = 0;
  std::uint64_t ticks = 0;
  std::uint64_t force_limited_ticks = 0;  ///< in which max_force_N held the device back
  std::uint64_t rate_limited_ticks = 0;   ///< in which its motors' rates did
  double max_contact_area = 0.0;          ///< m^2
  double max_normal_force = 0.0;          ///< N, of the magnitude of the vector sum
  double max_normal_force_sum = 0.0;      ///< N, of the sum of magnitudes
  double mount_shift = 0.0;               ///< of its device, m
  std::vector<DeviceNotice> notices;

  void add(const StepRecord& step);
  void add(const TickRecord& tick);
  void merge(const FingerSummary& other);
};

/// An object that moves by the forces on it, at the end of a run.
struct ObjectSummary {
  std::string name;
  std::string joint_unit;  ///< mm or deg; empty: no joint value
  ObjectRecord last;
};

struct RunSummary {
  std::int64_t steps = 0;
  std::optional<std::uint64_t> deadline_misses;  ///< empty: not paced by the wall clock
  FingerSummary all;                             ///< every step and tick of every finger
  std::vector<std::pair<std::string, FingerSummary>> fingers;
  std::vector<ObjectSummary> objects;
  /// What its user should know besides figures, one line each.
  std::vector<std::string> remarks;
  std::optional<std::filesystem::path> recording;
  std::uint64_t dropped_rows = 0;  ///< of the recording, which a live run never waits for
};

}  // namespace softfinger
