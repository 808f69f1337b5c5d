#include "softfinger/base/error.hpp"

#include <gtest/gtest.h>

namespace softfinger {
namespace {

TEST(Error, IsOneLineWhateverItQuotes) {
  EXPECT_STREQ(InputError("a.toml:1: unknown key 'x\ny\x1bz\x7f!'").what(),
               "a.toml:1: unknown key 'x?y?z?!'");
  EXPECT_STREQ(OperationError("/dev/\r: gone").what(), "/dev/?: gone");
  EXPECT_EQ(in_one_line("größer, 3 µm"), "größer, 3 µm");
}

}  // namespace
}  // namespace softfinger
