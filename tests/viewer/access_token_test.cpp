#include "softfinger/viewer/access_token.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "raw_client.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/viewer/server.hpp"
#include "synthetic_feed.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

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
  EXPECT_TRUE(token.is_in_cookies("a=b; softfinger-token=" + secret + "; c"));
  EXPECT_FALSE(token.is_in_cookies("softfinger-token=" + secret + "x"));
  EXPECT_FALSE(token.is_in_cookies("other=" + secret));
  EXPECT_FALSE(AccessToken().is_needed());
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
  EXPECT_THAT(admitted.header, HasSubstr("Set-Cookie: softfinger-token=" + secret +
                                         "; Path=/; "
                                         "HttpOnly; SameSite=Strict\r\n"));
  const std::string cookie = "Cookie: softfinger-token=" + secret + "\r\n";
  EXPECT_EQ(RawClient(server.port()).get("/", cookie).status, 200);
  EXPECT_EQ(RawClient(server.port()).open_web_socket(cookie).status, 101);
}

TEST_F(AccessTokenTest, IsNeededWhereOthersCanCome) {
  SyntheticFeed feed;
  try {
    const Server server(feed, {.address = "0.0.0.0", .port = 0});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--token"));
  }
  const Server server(feed, {.address = "0.0.0.0", .port = 0, .token = written(secret)});
  EXPECT_EQ(RawClient(server.port()).get("/").status, 401);
  EXPECT_EQ(RawClient(server.port()).get("/?token=" + secret).status, 303);
}

}  // namespace
}  // namespace softfinger
