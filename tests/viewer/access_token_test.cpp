#include "softfinger/viewer/access_token.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "raw_client.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/viewer/server.hpp"
#include "synthetic_feed.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// The header by which a visitor shows the cookie that this answer gave.
std::string cookie_of(const HttpAnswer& admitted) {
  const std::string field = "Set-Cookie: ";
  const std::size_t begin = admitted.header.find(field);
  if (begin == std::string::npos) return {};
  const std::size_t end = admitted.header.find(';', begin);
  return "Cookie: " + admitted.header.substr(begin + field.size(), end - begin - field.size()) +
         "\r\n";
}

class AccessTokenTest : public ::testing::Test {
 protected:
  ~AccessTokenTest() override { fs::remove(file); }
  AccessToken written(const std::string& content, fs::perms perms = fs::perms::owner_read) {
    fs::remove(file);
    std::ofstream(file) << content;
    fs::permissions(file, perms);
    return AccessToken::read(file);
  }
  std::string refusal(const std::string& content, fs::perms perms = fs::perms::owner_read) {
    try {
      (void)written(content, perms);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  fs::path file = fs::temp_directory_path() /
                  ("softfinger-token-" +
                   std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
  const std::string secret = "correct-horse_Battery9";
};

TEST_F(AccessTokenTest, KnowsItself) {
  const AccessToken token = written(secret + "\n");
  EXPECT_TRUE(token.is_needed());
  EXPECT_TRUE(token.matches(secret));
  EXPECT_FALSE(token.matches(""));
  EXPECT_FALSE(token.matches(secret.substr(1)));
  EXPECT_FALSE(token.matches(secret + "x"));
  EXPECT_TRUE(token.is_in_target("/?quality=high&token=" + secret));
  EXPECT_FALSE(token.is_in_target("/?token="));
  EXPECT_FALSE(token.is_in_target("/token=" + secret));
  EXPECT_FALSE(token.is_in_target("/?nottoken=" + secret));
  EXPECT_FALSE(AccessToken().is_needed());
}

TEST(VisitorCookie, IsOfOneServerAndPort) {
  const VisitorCookie cookie;
  EXPECT_EQ(cookie.value().size(), 64U);
  EXPECT_NE(cookie.value(), VisitorCookie().value());
  EXPECT_TRUE(cookie.is_in("a=b; softfinger-8080=" + cookie.value() + "; c", 8080));
  EXPECT_TRUE(cookie.is_in("softfinger-8080=x; softfinger-8080=" + cookie.value(), 8080));
  EXPECT_FALSE(cookie.is_in("softfinger-8080=" + cookie.value(), 8081));
  EXPECT_FALSE(cookie.is_in("softfinger-8080=" + cookie.value() + "x", 8080));
  EXPECT_FALSE(cookie.is_in("softfinger-8080=", 8080));
  EXPECT_FALSE(cookie.is_in("", 8080));
}

TEST_F(AccessTokenTest, RefusesWhatIsNoSecret) {
  EXPECT_THAT(refusal("short"), HasSubstr("16 to 128"));
  EXPECT_THAT(refusal(std::string(129, 'a')), HasSubstr("16 to 128"));
  EXPECT_THAT(refusal(secret + "\nmore lines of it"), HasSubstr("one line"));
  EXPECT_THAT(refusal("white space is not of it"), HasSubstr("letters"));
  EXPECT_THAT(refusal(secret, fs::perms::owner_read | fs::perms::others_read),
              HasSubstr("chmod 600"));
  EXPECT_THROW((void)AccessToken::read(file / "missing"), InputError);
}

TEST_F(AccessTokenTest, IsAskedForBeforeAnythingElse) {
  SyntheticFeed feed;
  const Server server(feed, {.port = 0, .token = written(secret)});
  EXPECT_THAT(server.url(), HasSubstr("/?token=" + secret));
  RawClient client(server.port());
  const HttpAnswer answer = client.get("/");
  EXPECT_EQ(answer.status, 401);
  EXPECT_THAT(answer.header + answer.body, Not(HasSubstr(secret)));
  EXPECT_EQ(RawClient(server.port()).get("/?token=wrong-wrong-wrong-wrong").status, 401);
  EXPECT_EQ(RawClient(server.port()).open_web_socket().status, 401);
  const HttpAnswer admitted = RawClient(server.port()).get("/?token=" + secret);
  EXPECT_EQ(admitted.status, 303);
  EXPECT_THAT(admitted.header, HasSubstr("Location: /\r\n"));
  const std::string cookie = cookie_of(admitted);
  EXPECT_THAT(cookie, HasSubstr("softfinger-" + std::to_string(server.port()) + "="));
  EXPECT_THAT(admitted.header, HasSubstr("; Path=/; HttpOnly; SameSite=Strict\r\n"));
  // Who reads a browser's files does not learn the token, and the token is no cookie.
  EXPECT_THAT(admitted.header, Not(HasSubstr(secret)));
  const std::string name = "Cookie: softfinger-" + std::to_string(server.port());
  EXPECT_EQ(RawClient(server.port()).get("/", name + "=" + secret + "\r\n").status, 401);
  EXPECT_EQ(RawClient(server.port()).get("/", name + "=\r\n").status, 401);
  EXPECT_EQ(RawClient(server.port()).get("/", cookie).status, 200);
  EXPECT_EQ(RawClient(server.port()).open_web_socket(cookie).status, 101);
}

TEST_F(AccessTokenTest, OfAnotherServerItsCookieIsNone) {
  SyntheticFeed feed, feed_of_other;
  const AccessToken token = written(secret);
  const Server one(feed, {.port = 0, .token = token});
  const Server other(feed_of_other, {.port = 0, .token = token});
  const HttpAnswer admitted = RawClient(one.port()).get("/?token=" + secret);
  const std::string cookie = cookie_of(admitted);
  EXPECT_EQ(RawClient(one.port()).get("/", cookie).status, 200);
  const std::string value = cookie.substr(cookie.find('='));
  const std::string name = "Cookie: softfinger-" + std::to_string(other.port());
  EXPECT_EQ(RawClient(other.port()).get("/", name + value).status, 401);
}

TEST_F(AccessTokenTest, StrangersKeepNobodyOutForLong) {
  SyntheticFeed feed;
  const Server server(feed, {.port = 0, .token = written(secret)});
  const std::string cookie = cookie_of(RawClient(server.port()).get("/?token=" + secret));
  RawClient kept(server.port());  // who has shown the cookie may stay silent for longer
  EXPECT_EQ(kept.get("/", cookie).status, 200);
  using Clock = std::chrono::steady_clock;
  const Clock::time_point began = Clock::now();
  std::vector<std::unique_ptr<RawClient>> strangers;
  for (int i = 0; i < 20; ++i) strangers.push_back(std::make_unique<RawClient>(server.port()));
  // One of them says something, but never all.
  strangers.front()->send("GET / HTTP/1.1\r\n");
  for (std::size_t i = 8; i < strangers.size(); ++i) EXPECT_TRUE(strangers[i]->is_closed()) << i;
  EXPECT_LT(Clock::now() - began, std::chrono::milliseconds(2500)) << "too many of one address";
  for (std::size_t i = 0; i < 8; ++i) EXPECT_TRUE(strangers[i]->is_closed()) << i;
  EXPECT_GT(Clock::now() - began, std::chrono::milliseconds(2500));
  EXPECT_LT(Clock::now() - began, std::chrono::seconds(7));
  EXPECT_EQ(kept.get("/", cookie).status, 200);
  EXPECT_EQ(RawClient(server.port()).get("/?token=" + secret).status, 303);
}

TEST_F(AccessTokenTest, OfManyVisitorsOnlyThoseWhoHaveItHoldPlaces) {
  SyntheticFeed feed;
  const Server server(feed, {.port = 0, .token = written(secret)});
  const std::string cookie = cookie_of(RawClient(server.port()).get("/?token=" + secret));
  std::vector<std::unique_ptr<RawClient>> visitors;
  for (int i = 0; i < 30; ++i) {
    visitors.push_back(std::make_unique<RawClient>(server.port()));
    EXPECT_EQ(visitors.back()->open_web_socket(cookie).status, 101) << i;
  }
}

TEST_F(AccessTokenTest, DoesNotGoUnencryptedToOthersUnlessTheNetworkIsTrusted) {
  SyntheticFeed feed;
  try {
    const Server server(feed, {.address = "0.0.0.0", .port = 0, .token = written(secret)});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--certificate FILE and --key FILE, or --plain-http"));
    EXPECT_THAT(error.what(), Not(HasSubstr(secret)));
  }
}

TEST_F(AccessTokenTest, IsNeededWhereOthersCanCome) {
  SyntheticFeed feed;
  try {
    const Server server(feed, {.address = "0.0.0.0", .port = 0, .plain_http = true});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--token"));
  }
  const Server server(
      feed, {.address = "0.0.0.0", .port = 0, .token = written(secret), .plain_http = true});
  EXPECT_EQ(RawClient(server.port()).get("/").status, 401);
  EXPECT_EQ(RawClient(server.port()).get("/?token=" + secret).status, 303);
}

}  // namespace
}  // namespace softfinger
