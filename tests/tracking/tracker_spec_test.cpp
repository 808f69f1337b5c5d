#include "softfinger/tracking/tracker_spec.hpp"

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

TEST(TrackerSpec, NatNetHasAHostABodyAndOptions) {
  const TrackerSpec least = parse_tracker_spec("natnet:10.0.0.2,body=index tip");
  EXPECT_EQ(least.kind, TrackerKind::kNatnet);
  EXPECT_EQ(least.address, "10.0.0.2");
  EXPECT_EQ(least.port, 1510);
  EXPECT_EQ(least.body, "index tip");
  EXPECT_EQ(least.up, UpAxis::kY);
  EXPECT_EQ(least.scale, 1.0);
  EXPECT_FALSE(least.multicast.has_value());
  const TrackerSpec most =
      parse_tracker_spec("natnet:motive.local:1600,up=z,scale=0.001,body=a=b,multicast");
  EXPECT_EQ(most.address, "motive.local");
  EXPECT_EQ(most.port, 1600);
  EXPECT_EQ(most.body, "a=b");
  EXPECT_EQ(most.up, UpAxis::kZ);
  EXPECT_EQ(most.scale, 0.001);
  EXPECT_EQ(most.multicast, true);
  EXPECT_EQ(parse_tracker_spec("natnet:h,body=b,unicast").multicast, false);
}

TEST(TrackerSpec, NatNetMistakesAreNamed) {
  const auto line = [](const char* spec) -> std::string {
    try {
      (void)parse_tracker_spec(spec);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  using testing::HasSubstr;
  EXPECT_THAT(line("natnet:"), HasSubstr("expected natnet:HOST[:PORT],body=NAME"));
  EXPECT_THAT(line("natnet:,body=a"), HasSubstr("expected natnet:HOST[:PORT],body=NAME"));
  EXPECT_THAT(line("natnet:h:0,body=a"), HasSubstr("port of 1 to 65535"));
  EXPECT_THAT(line("natnet:h:99999,body=a"), HasSubstr("port of 1 to 65535"));
  EXPECT_THAT(line("natnet:h"), HasSubstr("which rigid body?"));
  EXPECT_THAT(line("natnet:h,body="), HasSubstr("body= needs"));
  EXPECT_THAT(line("natnet:h,bdy=a"), HasSubstr("did you mean 'body'?"));
  EXPECT_THAT(line("natnet:h,body=a,up=x"), HasSubstr("up= must be y or z"));
  EXPECT_THAT(line("natnet:h,body=a,scale=0"), HasSubstr("scale= must be"));
  EXPECT_THAT(line("natnet:h,body=a,scale=nan"), HasSubstr("scale= must be"));
  EXPECT_THAT(line("natnet:h,body=a,scale=-1"), HasSubstr("scale= must be"));
  EXPECT_THAT(line("natnet:h,body=a,multicast=yes"), HasSubstr("unknown option 'multicast=yes'"));
  EXPECT_THAT(line("natnt:h,body=a"), HasSubstr("did you mean 'natnet'?"));
}

}  // namespace
}  // namespace softfinger
