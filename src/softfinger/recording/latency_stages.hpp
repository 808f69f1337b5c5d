#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "softfinger/base/histogram.hpp"

namespace softfinger {

/// Stages on the way from a finger to the servos, in order.
enum class LatencyStage {
  kExposure,  ///< the pose is true until it reaches this program, by the sender's clock
  kArrival,   ///< until a step takes it; longer where several steps share a pose
  kStep,      ///< until that step's contact is handed on
  kMatch,     ///< until the command is formed
  kSend,      ///< until it is written to the port
  kServo      ///< how long ago the servos were told to be where they are, see ServoLag
};
inline constexpr std::size_t kLatencyStages = 6;
inline constexpr std::array<const char*, kLatencyStages> kLatencyStageNames = {
    "exposure", "arrival", "step", "match", "send", "servo"};

/// What the stages of one command took, s; NaN where it is not known.
class StageTimes {
 public:
  StageTimes() { times_.fill(std::numeric_limits<double>::quiet_NaN()); }
  double& operator[](LatencyStage stage) { return times_[static_cast<std::size_t>(stage)]; }
  double operator[](LatencyStage stage) const { return times_[static_cast<std::size_t>(stage)]; }
  [[nodiscard]] const std::array<double, kLatencyStages>& all() const { return times_; }

 private:
  std::array<double, kLatencyStages> times_;
};

/// A histogram a stage, of the times that are known.
class StageHistograms {
 public:
  void add(const StageTimes& times) {
    for (std::size_t i = 0; i < kLatencyStages; ++i) {
      if (!std::isnan(times.all()[i])) histograms_[i].add(times.all()[i]);
    }
  }
  void merge(const StageHistograms& other) {
    for (std::size_t i = 0; i < kLatencyStages; ++i) histograms_[i].merge(other.histograms_[i]);
  }
  const Histogram& operator[](LatencyStage stage) const {
    return histograms_[static_cast<std::size_t>(stage)];
  }
  [[nodiscard]] const std::array<Histogram, kLatencyStages>& all() const { return histograms_; }

 private:
  std::array<Histogram, kLatencyStages> histograms_;
};

}  // namespace softfinger
