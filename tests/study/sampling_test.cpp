// Designs: every combination, one in each part of each range, evener than chance.
#include "softfinger/study/sampling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "study_place.hpp"

namespace softfinger {
namespace {

using testing::ElementsAre;

std::vector<std::vector<double>> designs_of(const std::string& vary, const std::string& design) {
  const StudyPlace place;
  return sampled_designs(place.study(
      fmt::format("device = \"membrane\"\n[vary]\n{}\n[objectives]\nf = {{ formula = \"1\" }}\n"
                  "[design]\n{}",
                  vary, design)));
}

constexpr const char* kThree =
    "device.mount.translation_mm.0 = { min = 0, max = 1 }\n"
    "device.mount.translation_mm.1 = { min = 2, max = 4 }\n"
    "device.mount.translation_mm.2 = { min = 1, max = 100, log = true }\n";

TEST(Sampling, AGridTakesEveryCombinationTheLastParameterFirst) {
  const auto designs = designs_of(
      "device.geometry.ring_radius_mm = { values = [7, 6] }\n"
      "device.mount.translation_mm.0 = { tie = \"device.geometry.ring_radius_mm\" }\n"
      "device.mount.translation_mm.1 = { min = 0, max = 1, count = 3 }\n",
      "kind = \"grid\"");
  ASSERT_EQ(designs.size(), 6u);
  EXPECT_THAT(designs[0], ElementsAre(7.0, 0.0));
  EXPECT_THAT(designs[1], ElementsAre(7.0, 0.5));
  EXPECT_THAT(designs[2], ElementsAre(7.0, 1.0));
  EXPECT_THAT(designs[3], ElementsAre(6.0, 0.0));
  EXPECT_THAT(designs[5], ElementsAre(6.0, 1.0));
}

TEST(Sampling, ALatinHypercubeHasEachPartOfEachRangeOnce) {
  constexpr std::size_t kSize = 50;
  const auto designs = designs_of(kThree, "kind = \"lhs\"\nsize = 50\nseed = 3");
  ASSERT_EQ(designs.size(), kSize);
  std::array<std::set<int>, 3> parts;
  for (const auto& one : designs) {
    parts[0].insert(static_cast<int>(one[0] * kSize));
    parts[1].insert(static_cast<int>((one[1] - 2.0) / 2.0 * kSize));
    parts[2].insert(static_cast<int>(std::log(one[2]) / std::log(100.0) * kSize));
  }
  for (const auto& each : parts) EXPECT_EQ(each.size(), kSize);
  EXPECT_EQ(designs, designs_of(kThree, "kind = \"lhs\"\nsize = 50\nseed = 3"));
  EXPECT_NE(designs, designs_of(kThree, "kind = \"lhs\"\nsize = 50\nseed = 4"));
}

// 2^k points of the sequence lie one in each of 2^k equal boxes, whatever the shift: of the first
// two coordinates, boxes of 16 by 16.
TEST(Sampling, SobolsSequenceIsANet) {
  for (const int seed : {0, 1, 7}) {
    const auto designs =
        designs_of(kThree, fmt::format("kind = \"sobol\"\nsize = 256\nseed = {}", seed));
    std::set<std::pair<int, int>> boxes;
    for (std::size_t i = 0; i < designs.size(); ++i) {
      boxes.emplace(static_cast<int>(designs[i][0] * 16.0),
                    static_cast<int>((designs[i][1] - 2.0) * 8.0));
    }
    // The library leaves out the sequence's first point, so that one box may have two.
    EXPECT_GE(boxes.size(), 255u) << seed;
  }
}

TEST(Sampling, ValuesTakeEvenSharesOfARange) {
  const auto designs = designs_of("device.geometry.ring_radius_mm = { values = [6, 7, 8] }",
                                  "kind = \"lhs\"\nsize = 30");
  std::map<double, int> counts;
  for (const auto& one : designs) ++counts[one[0]];
  EXPECT_EQ(counts[6.0], 10);
  EXPECT_EQ(counts[7.0], 10);
  EXPECT_EQ(counts[8.0], 10);
}

}  // namespace
}  // namespace softfinger
