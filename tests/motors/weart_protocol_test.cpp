#include "softfinger/motors/weart/weart_protocol.hpp"

#include <gmock/gmock.h>

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger {
namespace {

std::string force_text(double force, std::string_view address) {
  std::array<char, 128> text{};
  return {text.data(), encode_weart_force(force, address, text)};
}

std::vector<WeartRequest> requests_in(WeartReader& reader, std::string_view text) {
  std::vector<WeartRequest> requests;
  for (const char letter : text) {
    if (auto request = reader.push(static_cast<std::uint8_t>(letter))) {
      requests.push_back(*request);
    }
  }
  return requests;
}

// Messages as WEART's SDK writes them.
TEST(WeartProtocol, SaysTheMessagesOfTheSdk) {
  EXPECT_EQ(force_text(0.8, "RIGHT:INDEX"), "force:0.800000:0.000000:0.000000:RIGHT:INDEX~");
  std::array<char, 64> text{};
  const std::size_t size = encode_weart_stop_force("LEFT:THUMB", text);
  EXPECT_EQ(std::string_view(text.data(), size), "stopForce:LEFT:THUMB~");
  EXPECT_THAT(weart_start(), testing::MatchesRegex("StartFromClient:[a-z]+:[0-9.]+:TrackType1~"));
  // What does not fit is not sent in part.
  EXPECT_EQ(encode_weart_force(0.5, "RIGHT:INDEX", std::span(text).first(20)), 0u);
}

TEST(WeartProtocol, ReadsWhatItWrites) {
  WeartReader reader;
  for (int k = 0; k <= 1000; ++k) {
    const auto requests = requests_in(reader, force_text(k * 1e-3, "LEFT:PALM"));
    ASSERT_EQ(requests.size(), 1u);
    EXPECT_EQ(requests[0].kind, WeartRequest::Kind::kForce);
    EXPECT_NEAR(requests[0].force, k * 1e-3, 5e-7);
    EXPECT_EQ(requests[0].address, "LEFT:PALM");
  }
  EXPECT_EQ(reader.malformed(), 0u);
}

TEST(WeartProtocol, RefusesWhatIsNoMessage) {
  for (const std::string bad :
       {"force:1.5:0:0:RIGHT:INDEX~", "force:-0.1:0:0:RIGHT:INDEX~", "force:nan:0:0:RIGHT:INDEX~",
        "force:0.5:0:0:RIGHT~", "force:0.5:0:0:UP:INDEX~", "force:0.5:0:0:RIGHT:NOSE~", "~",
        "stopForce:RIGHT~", "a:b:c:d:e:f:g:h:i~", "force:0.5x:0:0:RIGHT:INDEX~"}) {
    WeartReader reader;
    EXPECT_TRUE(requests_in(reader, bad).empty()) << bad;
    EXPECT_EQ(reader.malformed(), 1u) << bad;
    EXPECT_EQ(requests_in(reader, "stopForce:RIGHT:INDEX~").size(), 1u);
  }
  WeartReader reader;
  std::string endless(100000, 'x');
  endless.back() = '~';
  EXPECT_TRUE(requests_in(reader, endless).empty());
  EXPECT_EQ(requests_in(reader, "StopFromClient~").size(), 1u);
}

}  // namespace
}  // namespace softfinger
