#include "softfinger/base/hash.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <vector>

namespace softfinger {
namespace {

TEST(Hash, KnownValueOfNothing) { EXPECT_EQ(Hash().value(), 0xef46db3751d8e999u); }

TEST(Hash, KnownValueOfText) {
  const std::vector<char> text{'a', 'b', 'c'};
  EXPECT_EQ(Hash().add(std::span<const char>(text)).value(), 0x44bc2cf5ad770999u);
}

TEST(Hash, PiecesGiveTheHashOfTheWhole) {
  std::vector<double> values(1000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.1 * static_cast<double>(i);
  const std::span<const double> all(values);
  Hash pieces;
  for (const double value : values) pieces.add(value);
  EXPECT_EQ(pieces.value(), Hash().add(all).value());
  EXPECT_EQ(Hash().add(all.first(7)).add(all.subspan(7)).value(), Hash().add(all).value());
}

TEST(Hash, AnEmptySpanAddsNothing) {
  EXPECT_EQ(Hash().add(1.0).add(std::span<const double>()).value(), Hash().add(1.0).value());
}

TEST(Hash, SeesTheLastBit) {
  const double value = 1.0;
  EXPECT_NE(Hash().add(value).value(), Hash().add(value + 2.3e-16).value());
  EXPECT_NE(Hash().add(0.0).value(), Hash().add(-0.0).value());
}

TEST(Hash, CopiesGoOnByThemselves) {
  Hash first;
  first.add(1);
  Hash second = first;
  EXPECT_EQ(first.value(), second.value());
  second.add(2);
  EXPECT_NE(first.value(), second.value());
}

TEST(Hash, VectorsAreTheirCoefficients) {
  const Eigen::Vector3d vector(1.0, 2.0, 3.0);
  EXPECT_EQ(Hash().add(vector).value(), Hash().add(1.0).add(2.0).add(3.0).value());
}

}  // namespace
}  // namespace softfinger
