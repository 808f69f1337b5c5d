#include "softfinger/world/body_rest.hpp"

#include <algorithm>
#include <cmath>

namespace softfinger {

BodyRest::BodyRest(std::size_t bodies, double time_step)
    : rest_steps_(static_cast<int>(std::ceil(kRestTime / time_step))),
      groups_(bodies, -1),
      times_(bodies) {}

void BodyRest::reset() {
  sleeping_ = 0;
  std::ranges::fill(groups_, -1);
  std::ranges::fill(times_, Time{});
}

void BodyRest::wake(std::size_t b) {
  const int group = groups_[b];
  if (group < 0) return;
  for (std::size_t other = 0; other < groups_.size(); ++other) {
    if (groups_[other] != group) continue;
    groups_[other] = -1;
    --sleeping_;
    disturb(other);
  }
}

void BodyRest::look(std::size_t b, const Pose& X_WO, double reach, double speed) {
  Time& time = times_[b];
  const double way = (X_WO.translation - time.since.translation).norm() +
                     reach * (X_WO.rotation - time.since.rotation).norm();
  if (time.steps > 0 && way <= kRestWay && speed <= kRestSpeed) {
    time.steps = std::min(time.steps + 1, rest_steps_);
    return;
  }
  time = {1, X_WO};
}

void BodyRest::fall_asleep(std::span<const std::size_t> bodies) {
  for (const std::size_t b : bodies) {
    groups_[b] = static_cast<int>(bodies.front());
    ++sleeping_;
  }
}

}  // namespace softfinger
