#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "pad.hpp"

namespace softfinger {

/// The samples of a pad as a device takes them, contacts first; separation as in the scene.
struct PackedPad {
  explicit PackedPad(const Pad& pad) {
    for (const int touching : {1, 0}) {
      for (std::size_t i = 0; i < pad.points.size(); ++i) {
        if (pad.in_contact[i] != touching) continue;
        x.push_back(pad.points[i].x());
        y.push_back(pad.points[i].y());
        z.push_back(pad.points[i].z());
        margin.push_back(std::max(0.0, std::min(0.2 * mm, pad.gaps[i])));
      }
    }
    weight.assign(x.size(), 1.0);
    contacts = pad.contacts();
  }
  [[nodiscard]] SurfaceSamples view() const { return {x, y, z, weight, margin, contacts}; }
  std::vector<double> x, y, z, weight, margin;
  int contacts = 0;
};

/// Least E that a search without derivatives finds from q, within the workspace: an evolution
/// strategy with the one-fifth rule, in the metric of the axes, from steps of `step` (m) to 0.1 um.
inline double descend_at_random(const Device& device, const SurfaceSamples& samples,
                                Configuration q, std::mt19937& random, double step = 2.0 * mm) {
  std::normal_distribution<double> normal(0.0, 1.0);
  double value = device.deviation(q, samples);
  while (step > 1e-7) {
    Configuration trial = q;
    for (int k = 0; k < q.size(); ++k) {
      trial[k] += step * normal(random) / device.axes()[static_cast<std::size_t>(k)].metric;
    }
    const double trial_value = device.deviation(trial, samples);
    const bool better = trial_value < value && device.reachable(trial);
    step *= better ? 1.8 : 0.87;
    if (!better) continue;
    q = trial;
    value = trial_value;
  }
  return value;
}

}  // namespace softfinger
