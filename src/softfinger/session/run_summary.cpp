#include "softfinger/session/run_summary.hpp"

namespace softfinger {

void CountHistogram::add(std::int64_t number) {
  const auto index =
      static_cast<std::size_t>(std::clamp<std::int64_t>(number, 0, std::int64_t{kMost}));
  ++counts_[index];
  ++total_;
  max_ = std::max(max_, number);
}

void CountHistogram::merge(const CountHistogram& other) {
  for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
  total_ += other.total_;
  max_ = std::max(max_, other.max_);
}

std::int64_t CountHistogram::percentile(double percent) const {
  const double wanted = static_cast<double>(total_) * percent / 100.0;
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    seen += counts_[i];
    if (seen > 0 && static_cast<double>(seen) >= wanted) return static_cast<std::int64_t>(i);
  }
  return max_;
}

void FingerSummary::add(const StepRecord& step) {
  step_cpu_time.add(step.cpu_time);
  step_wall_time.add(step.wall_time);
  if (step.tracked.valid) pose_age.add(step.time - step.tracked.time);
  iterations.add(step.iterations);
  if (!step.converged) ++unconverged_steps;
  max_contact_area = std::max(max_contact_area, step.contact_area);
  max_normal_force = std::max(max_normal_force, step.normal_force);
  max_normal_force_sum = std::max(max_normal_force_sum, step.normal_force_sum);
}

void FingerSummary::add(const TickRecord& tick) {
  match_cpu_time.add(tick.cpu_time);
  latency.add(tick.latency);
  stages.add(tick.stages);
  ++ticks;
  if (tick.command.force_limited) ++force_limited_ticks;
  if (tick.command.rate_limited) ++rate_limited_ticks;
}

void FingerSummary::merge(const FingerSummary& other) {
  step_cpu_time.merge(other.step_cpu_time);
  step_wall_time.merge(other.step_wall_time);
  match_cpu_time.merge(other.match_cpu_time);
  latency.merge(other.latency);
  stages.merge(other.stages);
  pose_age.merge(other.pose_age);
  iterations.merge(other.iterations);
  unconverged_steps += other.unconverged_steps;
  commands_sent += other.commands_sent;
  ticks += other.ticks;
  force_limited_ticks += other.force_limited_ticks;
  rate_limited_ticks += other.rate_limited_ticks;
  max_contact_area = std::max(max_contact_area, other.max_contact_area);
  max_normal_force = std::max(max_normal_force, other.max_normal_force);
  max_normal_force_sum = std::max(max_normal_force_sum, other.max_normal_force_sum);
}

}  // namespace softfinger
