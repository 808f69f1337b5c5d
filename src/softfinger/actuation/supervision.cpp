#include "softfinger/actuation/supervision.hpp"

#include <algorithm>
#include <limits>

namespace softfinger {

Supervision::Supervision(const Device& device)
    : most_error_(device.settings().following_error),
      most_pressing_(device.settings().press_time) {}

void Supervision::restart() {
  for (Stretch& stretch : stretches_) stretch.least.resize(0);
  astray_reports_.fill(0);
}

void Supervision::sent(double time, const JointAngles& joints) {
  constexpr double kLength = kFollowTime / static_cast<double>(kStretches - 1);
  Stretch& now = stretches_[newest_];
  if (now.least.size() == joints.size() && time - now.begin < kLength) {
    now.least = now.least.cwiseMin(joints);
    now.largest = now.largest.cwiseMax(joints);
    return;
  }
  newest_ = (newest_ + 1) % kStretches;
  stretches_[newest_] = {time, joints, joints};
}

std::uint32_t Supervision::seen(double time, const JointAngles& joints) {
  constexpr double kBeyond = std::numeric_limits<double>::infinity();
  Stretch all{time, JointAngles::Constant(joints.size(), kBeyond),
              JointAngles::Constant(joints.size(), -kBeyond)};
  for (const Stretch& stretch : stretches_) {
    if (stretch.least.size() != joints.size()) continue;
    all.begin = std::min(all.begin, stretch.begin);
    all.least = all.least.cwiseMin(stretch.least);
    all.largest = all.largest.cwiseMax(stretch.largest);
  }
  // Before that it may still be on its way from where it stood.
  if (!(most_error_ > 0.0) || time - all.begin < kFollowTime) return 0;
  std::uint32_t astray = 0;
  const auto servos = std::min<std::size_t>(static_cast<std::size_t>(joints.size()), kMostServos);
  for (std::size_t i = 0; i < servos; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    const bool follows = joints[joint] >= all.least[joint] - most_error_ &&
                         joints[joint] <= all.largest[joint] + most_error_;
    astray_reports_[i] = follows ? 0 : std::min(astray_reports_[i] + 1, kReports);
    if (astray_reports_[i] == kReports) astray |= 1U << i;
  }
  return astray;
}

bool Supervision::pressed_too_long(double time, bool pressing) {
  if (pressing) {
    if (!pressed_since_) pressed_since_ = time;
    last_pressed_ = time;
  } else if (pressed_since_ && time - last_pressed_ >= kPause) {
    pressed_since_.reset();
  }
  return most_pressing_ > 0.0 && pressed_since_ && time - *pressed_since_ > most_pressing_;
}

}  // namespace softfinger
