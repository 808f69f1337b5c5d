#pragma once

#include <gtest/gtest.h>

#include <string>

namespace softfinger {

/// A test's name after the shipped file that it is about: `pins-wagner-6x6` is pinswagner6x6.
template <typename Name>
std::string name_of_file(const testing::TestParamInfo<Name>& file) {
  std::string name = file.param;
  std::erase(name, '-');
  return name;
}

}  // namespace softfinger
