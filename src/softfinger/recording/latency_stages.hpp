#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "softfinger/base/histogram.hpp"
#include "softfinger/base/name_table.hpp"

namespace softfinger {

/// Stages on the way from a finger to the servos, in order.
enum class LatencyStage {
  kExposure,
  kArrival,  ///< longer where several steps share a pose
  kStep,
  kMatch,
  kSend,
  kServo  ///< see ServoLag
};
inline constexpr std::size_t kLatencyStages = 6;
/// In the order of the enumerators.
inline constexpr std::array<NameRow<LatencyStage>, kLatencyStages> kLatencyStageNames{{
    {LatencyStage::kExposure, "exposure",
     "the pose is true until it reaches the program, by the sender's clock"},
    {LatencyStage::kArrival, "arrival", "until a step takes it"},
    {LatencyStage::kStep, "step", "until that step's contact is handed on"},
    {LatencyStage::kMatch, "match", "until the command is formed"},
    {LatencyStage::kSend, "send", "until it is written to the port"},
    {LatencyStage::kServo, "servo", "how long ago the servos were told to be where they are"},
}};

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
