#include "softfinger/base/tracker_kind.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

TEST(TrackerSpec, ListenersAreOnLoopbackUnlessToldOtherwise) {
  const TrackerSpec udp = parse_tracker_spec("udp:7001");
  EXPECT_EQ(udp.kind, TrackerKind::kUdp);
  EXPECT_EQ(udp.address, "127.0.0.1");
  EXPECT_EQ(udp.port, 7001);
  const TrackerSpec osc = parse_tracker_spec("osc:0.0.0.0:9000");
  EXPECT_EQ(osc.kind, TrackerKind::kOsc);
  EXPECT_EQ(osc.address, "0.0.0.0");
  EXPECT_EQ(osc.port, 9000);
}

TEST(TrackerSpec, ListenersNeedAPort) {
  for (const char* spec : {"udp", "udp:", "udp:0", "udp:65536", "udp:-1", "udp:7001x", "udp:x",
                           "osc:localhost:9000", "osc:1.2.3:9000", "osc:1.2.3.256:9000",
                           "osc:1.2.3.4.5:9000", "osc::9000", "osc:1.2.3.4:"}) {
    try {
      (void)parse_tracker_spec(spec);
      ADD_FAILURE() << spec;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(":ADDRESS:PORT")) << spec;
    }
  }
}

}  // namespace
}  // namespace softfinger
