#include "softfinger/base/name_table.hpp"

#include <gtest/gtest.h>

#include <array>

namespace softfinger {
namespace {

enum class Fruit { kApple, kPear, kQuince };
constexpr std::array<NameRow<Fruit>, 2> kFruits{{
    {Fruit::kPear, "pear", "a pear"},
    {Fruit::kApple, "apple", "an apple"},
}};

TEST(NameTable, FindsRowsByValueAndByName) {
  EXPECT_EQ(row_of(kFruits, Fruit::kApple).words, "an apple");
  EXPECT_EQ(row_of(kFruits, Fruit::kQuince).value, Fruit::kPear);
  ASSERT_NE(row_named(kFruits, "pear"), nullptr);
  EXPECT_EQ(row_named(kFruits, "pear")->value, Fruit::kPear);
  EXPECT_EQ(row_named(kFruits, "Pear"), nullptr);
  EXPECT_EQ(row_named(kFruits, ""), nullptr);
}

TEST(NameTable, ListsNamesInOrder) {
  const std::vector<std::string> names = names_of(kFruits);
  EXPECT_EQ(names, (std::vector<std::string>{"pear", "apple"}));
  EXPECT_EQ(listed(names, "or"), "pear or apple");
  EXPECT_EQ(listed({"a", "b", "c"}, "and"), "a, b and c");
  EXPECT_EQ(listed({"a"}, "or"), "a");
  EXPECT_EQ(listed({}, "or"), "");
}

}  // namespace
}  // namespace softfinger
