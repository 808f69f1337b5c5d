#include "softfinger/wearer/advance.hpp"

#include <cmath>

namespace softfinger {

Configuration advanced(const Device& device, const Configuration& from, double by) {
  Configuration q = from;
  device.advance(by, q);
  return q;
}

double advance_between(const Device& device, const Configuration& from, const Configuration& q) {
  Configuration ahead = Configuration::Zero(q.size());
  device.advance(1.0, ahead);
  return (q - from).dot(ahead) / ahead.squaredNorm();
}

bool step_towards(const Device& device, const Configuration& goal, double step, Configuration& q) {
  const double way = std::sqrt(device.squared_distance(goal, q));
  if (way <= step) {
    q = goal;
    return true;
  }
  q += (goal - q) * (step / way);
  return false;
}

}  // namespace softfinger
