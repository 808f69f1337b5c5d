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
  Pose& since = times_[b].since;
  const double way = (X_WO.translation - since.translation).norm() +
                     reach * (X_WO.rotation - since.rotation).norm();
  if (look(b, way, speed)) since = X_WO;
}

bool BodyRest::look(std::size_t b, double way, double speed) {
  int& steps = times_[b].steps;
  const bool anew = steps == 0 || way > kRestWay || speed > kRestSpeed;
  steps = anew ? 1 : std::min(steps + 1, rest_steps_);
  return anew;
}

void BodyRest::fall_asleep(std::span<const std::size_t> bodies) {
  for (const std::size_t b : bodies) {
    groups_[b] = static_cast<int>(bodies.front());
    ++sleeping_;
  }
}

}  // namespace softfinger
