#include <gtest/gtest.h>

#include <algorithm>

#include "pad.hpp"

namespace softfinger {
namespace {

/// Least E in the workspace by starts of a random search that knows no derivatives.
double random_search(const Device& device, const SurfaceSamples& samples, std::mt19937& random) {
  const int n = device.degrees_of_freedom();
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  double least = 1.0;
  for (int start = 0; start < 16; ++start) {
    Configuration q(n);
    do {
      for (int k = 0; k < n; ++k) {
        const ConfigurationAxis& axis = device.axes()[static_cast<std::size_t>(k)];
        q[k] = axis.min + (axis.max - axis.min) * unit(random);
      }
    } while (!device.reachable(q));
    double value = device.deviation(q, samples);
    // Evolution strategy with the one-fifth rule, in the metric of the axes, to 0.1 um.
    for (double step = 2.0 * mm; step > 1e-7;) {
      Configuration trial = q;
      for (int k = 0; k < n; ++k) {
        trial[k] += step * normal(random) / device.axes()[static_cast<std::size_t>(k)].metric;
      }
      const double trial_value = device.deviation(trial, samples);
      const bool better = trial_value < value && device.reachable(trial);
      step *= better ? 1.8 : 0.87;
      if (!better) continue;
      q = trial;
      value = trial_value;
    }
    least = std::min(least, value);
  }
  return least;
}

std::string name_of_kind(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

class KindsMatching : public testing::TestWithParam<std::string> {};

// Cold and from the last answer, within 0.1 % of what the search finds.
TEST_P(KindsMatching, FindsTheGlobalMinimum) {
  const auto device = load_device(SOFTFINGER_SOURCE_DIR "/devices/" + GetParam() + ".toml");
  std::mt19937 random(21);
  ContactSurfaceMatching matching(device, 120);
  Configuration warm = device->home();
  for (int i = 0; i < 25; ++i) {
    const Pad pad = random_press(random, 25.0);
    if (pad.contacts() == 0) continue;
    std::vector<double> x, y, z, weight(pad.points.size(), 1.0), margin;
    for (const int touching : {1, 0}) {
      for (std::size_t k = 0; k < pad.points.size(); ++k) {
        if (pad.in_contact[k] != touching) continue;
        x.push_back(pad.points[k].x());
        y.push_back(pad.points[k].y());
        z.push_back(pad.points[k].z());
        margin.push_back(std::min(0.2 * mm, pad.gaps[k]));
      }
    }
    const SurfaceSamples samples{x, y, z, weight, margin, pad.contacts()};
    const double least = random_search(*device, samples, random);
    for (const bool cold : {true, false}) {
      const MatchingResult result = matching.solve(pad.view(), {}, cold ? nullptr : &warm);
      EXPECT_TRUE(device->reachable(result.configuration));
      EXPECT_NEAR(result.deviation, device->deviation(result.configuration, samples),
                  1e-9 * result.deviation + 1e-20);
      EXPECT_LE(result.deviation, 1.001 * least + 1e-14) << i << (cold ? " cold" : " warm");
      warm = result.configuration;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, KindsMatching,
                         testing::Values("plate-2dof", "cable-prattichizzo", "delta-schorr",
                                         "membrane", "roller-provancher"),
                         name_of_kind);

}  // namespace
}  // namespace softfinger
