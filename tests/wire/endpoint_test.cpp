#include "softfinger/wire/endpoint.hpp"

#include <gtest/gtest.h>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

TEST(Endpoint, IsFoundByNumbersAndByName) {
  for (const char* text : {"127.0.0.1:9000", "localhost:9000"}) {
    Endpoint endpoint;
    EXPECT_EQ(find_endpoint(text, endpoint), "") << text;
    EXPECT_EQ(endpoint, (Endpoint{kLoopback, 9000})) << text;
    EXPECT_EQ(text_of(endpoint), "127.0.0.1:9000");
  }
  EXPECT_EQ(find_address("1.2.3.4"), 0x01020304u);
  EXPECT_EQ(address_text(0x01020304u), "1.2.3.4");
}

TEST(Endpoint, SaysWhatIsWrong) {
  for (const char* text : {"", "nowhere", ":9000", "127.0.0.1:", "127.0.0.1:0", "127.0.0.1:70000",
                           "127.0.0.1:9x", "127.0.0.1:-1"}) {
    Endpoint endpoint;
    EXPECT_EQ(find_endpoint(text, endpoint), "it must be HOST:PORT, such as 127.0.0.1:9000")
        << text;
    EXPECT_EQ(endpoint, Endpoint()) << text;
  }
  Endpoint endpoint;
  EXPECT_EQ(find_endpoint("no.such.host.invalid:9", endpoint),
            "no machine of the name no.such.host.invalid is known");
  EXPECT_THROW((void)find_address("no.such.host.invalid"), InputError);
}

}  // namespace
}  // namespace softfinger
