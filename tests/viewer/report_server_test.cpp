// The page of a running study: what it serves, to whom, and how it follows what changes.
#include "softfinger/viewer/report_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>

#include "raw_client.hpp"
#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ReportServerTest : public ::testing::Test {
 protected:
  HttpAnswer get(std::string_view target, std::string_view extra = "") {
    RawClient client(server.port());
    return client.get(target, extra);
  }

  std::atomic<int> done{0};
  ReportServer server{PagePort({.port = 0}),
                      [this](std::string_view path) -> std::optional<std::string> {
                        if (path == "/progress.json") return "[" + std::to_string(done++) + "]";
                        if (path == "/report.html") return std::string(3'000'000, 'x');
                        return std::nullopt;
                      }};
};

TEST_F(ReportServerTest, ServesWhatChangesAsItIs) {
  RawClient client(server.port());
  EXPECT_EQ(client.get("/progress.json").body, "[0]");
  const HttpAnswer second = client.get("/progress.json?x=1");
  EXPECT_EQ(second.body, "[1]");
  EXPECT_THAT(second.header, HasSubstr("Content-Type: application/json\r\n"));
  EXPECT_THAT(second.header, HasSubstr("Cache-Control: no-cache"));
  const HttpAnswer report = client.get("/report.html");
  EXPECT_EQ(report.body.size(), 3'000'000u) << "kept until it is sent";
  EXPECT_THAT(report.header, HasSubstr("Content-Type: text/html; charset=utf-8\r\n"));
  EXPECT_EQ(client.get("/progress.json").body, "[2]");
}

TEST_F(ReportServerTest, IsForThisMachinesOwnPagesAlone) {
  EXPECT_EQ(server.url(), "http://127.0.0.1:" + std::to_string(server.port()));
  EXPECT_EQ(get("/progress.json", "Origin: http://example.org\r\n").status, 403);
  RawClient foreign(server.port());
  foreign.send("GET /progress.json HTTP/1.1\r\nHost: example.org\r\n\r\n");
  EXPECT_EQ(foreign.read_answer().status, 403);
  EXPECT_EQ(done, 0);
}

TEST_F(ReportServerTest, HasNothingElse) {
  EXPECT_EQ(get("/ws").status, 404);
  EXPECT_EQ(get("/index.html").status, 404) << "the live page";
  EXPECT_EQ(get("/../progress.json").status, 404);
  RawClient client(server.port());
  EXPECT_EQ(
      client.open_web_socket("Origin: http://127.0.0.1:" + std::to_string(server.port()) + "\r\n")
          .status,
      404);
}

TEST_F(ReportServerTest, ItsPortIsRefusedWhereItIsInUse) {
  EXPECT_THROW(PagePort({.port = server.port()}), InputError);
}

#if defined(SOFTFINGER_LIVE_PAGE)
TEST_F(ReportServerTest, ThePageIsBuiltAndWhole) {
  const HttpAnswer page = get("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_THAT(page.body, HasSubstr("softfinger study"));
  EXPECT_THAT(page.body, Not(HasSubstr("http")));
  // Its scripts and styles, each of which is there.
  int assets = 0;
  for (std::size_t at = page.body.find("/assets/"); at != std::string::npos;
       at = page.body.find("/assets/", at + 1)) {
    ++assets;
    EXPECT_EQ(get(page.body.substr(at, page.body.find('"', at) - at)).status, 200);
  }
  EXPECT_GE(assets, 2) << "a script and a style";
}
#endif

}  // namespace
}  // namespace softfinger
