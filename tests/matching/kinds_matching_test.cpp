#include <gtest/gtest.h>

#include <algorithm>

#include "../support/folders.hpp"
#include "pad.hpp"
#include "random_descent.hpp"

namespace softfinger {
namespace {

/// Least E in the workspace by random starts.
double random_search(const Device& device, const SurfaceSamples& samples, std::mt19937& random) {
  const int n = device.degrees_of_freedom();
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double least = 1.0;
  for (int start = 0; start < 16; ++start) {
    Configuration q(n);
    do {
      for (int k = 0; k < n; ++k) {
        const ConfigurationAxis& axis = device.axes()[static_cast<std::size_t>(k)];
        q[k] = axis.min + (axis.max - axis.min) * unit(random);
      }
    } while (!device.reachable(q));
    least = std::min(least, descend_at_random(device, samples, q, random));
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
  const auto device = load_device(source_folder() + "/devices/" + GetParam() + ".toml");
  std::mt19937 random(21);
  ContactSurfaceMatching matching(device, 120);
  Configuration warm = device->home();
  int touching = 0;
  for (int i = 0; i < 25; ++i) {
    const Pad pad = random_press(random, 25.0);
    if (pad.contacts() == 0) continue;
    ++touching;
    const PackedPad packed(pad);
    const SurfaceSamples samples = packed.view();
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
  EXPECT_GT(touching, 12);
}

INSTANTIATE_TEST_SUITE_P(Devices, KindsMatching,
                         testing::Values("plate-2dof", "cable-prattichizzo", "delta-schorr",
                                         "membrane", "roller-provancher", "disk-linear"),
                         name_of_kind);

}  // namespace
}  // namespace softfinger
