#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "play.hpp"

namespace softfinger {

/// How many sleep in two plays of one scene, alike in all bits, as often as it changes; a look each
/// tenth of a second.
inline std::vector<std::size_t> sleeping_in_both(Play& one, Play& other, double duration) {
  std::vector<std::size_t> sleeping;
  const auto looks = std::lround(10.0 * duration);
  for (long k = 0; k < looks; ++k) {
    one.run(0.1);
    other.run(0.1);
    EXPECT_EQ(one.world().state_hash(), other.world().state_hash()) << one.time();
    EXPECT_EQ(one.world().work().sleeping, other.world().work().sleeping);
    if (testing::Test::HasFailure()) break;
    if (sleeping.empty() || sleeping.back() != one.world().work().sleeping) {
      sleeping.push_back(one.world().work().sleeping);
    }
  }
  return sleeping;
}

}  // namespace softfinger
