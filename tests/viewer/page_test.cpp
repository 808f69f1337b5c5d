#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "softfinger/viewer/own_address.hpp"
#include "softfinger/viewer/page_file.hpp"

namespace softfinger {
namespace {

constexpr std::array<PageFile, 2> kSmallPage{{
    {"/index.html", "text/html; charset=utf-8", "<p>page"},
    {"/assets/page.css", "text/css; charset=utf-8", "p {}"},
}};

TEST(PageFile, RootIsTheIndex) {
  ASSERT_NE(find_page_file(kSmallPage, "/"), nullptr);
  EXPECT_EQ(find_page_file(kSmallPage, "/")->path, "/index.html");
}

TEST(PageFile, QueryIsIgnored) {
  EXPECT_EQ(find_page_file(kSmallPage, "/?scene=edge"), find_page_file(kSmallPage, "/"));
  EXPECT_EQ(find_page_file(kSmallPage, "/assets/page.css?v=2")->content_type,
            "text/css; charset=utf-8");
}

TEST(PageFile, NothingOutsideThePage) {
  for (const char* target :
       {"", "?", "*", "//", "/etc/passwd", "/../index.html", "/assets/../index.html", "/assets",
        "/index.html/", "/INDEX.HTML", "http://127.0.0.1/index.html"}) {
    EXPECT_EQ(find_page_file(kSmallPage, target), nullptr) << target;
  }
}

#if defined(SOFTFINGER_LIVE_PAGE)
TEST(PageFile, TheBuiltPageIsWhole) {
  const auto page = live_page();
  const PageFile* index = find_page_file(page, "/");
  ASSERT_NE(index, nullptr);
  EXPECT_EQ(index->content_type, "text/html; charset=utf-8");
  EXPECT_TRUE(index->content.starts_with("<!doctype html>"));
  // Every file is named by another, and nothing is fetched from elsewhere.
  int assets = 0;
  for (const PageFile& file : page) {
    if (!file.path.starts_with("/assets/index")) continue;
    ++assets;
    const std::string_view name = file.path.substr(file.path.rfind('/') + 1);
    EXPECT_TRUE(std::ranges::any_of(page, [&](const PageFile& other) {
      return other.path != file.path && other.content.find(name) != std::string_view::npos;
    })) << file.path;
  }
  EXPECT_GE(assets, 2) << "a script and a style";
  EXPECT_EQ(index->content.find("http"), std::string_view::npos);
}

TEST(PageFile, ModelsAreServedAsTheyAre) {
  int models = 0;
  for (const PageFile& file : live_page()) {
    if (!file.path.ends_with(".glb")) continue;
    ++models;
    EXPECT_EQ(file.content_type, "model/gltf-binary");
    EXPECT_TRUE(file.content.starts_with("glTF")) << file.path;
    // glTF 2.0, 4.4.2: bytes 8 to 11 are the length of the whole, low byte first.
    ASSERT_GE(file.content.size(), 12U);
    const auto byte = [&](std::size_t k) -> std::size_t {
      return static_cast<unsigned char>(file.content[k]);
    };
    EXPECT_EQ(file.content.size(), byte(8) | byte(9) << 8 | byte(10) << 16 | byte(11) << 24);
  }
  EXPECT_EQ(models, 2) << "a left and a right hand";
}
#endif

TEST(OwnAddress, OwnHostsOnly) {
  EXPECT_TRUE(is_own_host("127.0.0.1:8080", "127.0.0.1", 8080));
  EXPECT_TRUE(is_own_host("localhost:8080", "127.0.0.1", 8080));
  EXPECT_TRUE(is_own_host("localhost", "127.0.0.1", 80));
  for (const char* host : {"", "localhost", "127.0.0.1", "127.0.0.1:80", "127.0.0.1:80800",
                           "localhost:8080.example.org", "example.org:8080", "127.0.0.2:8080",
                           "localhost:8080 ", "user@localhost:8080"}) {
    EXPECT_FALSE(is_own_host(host, "127.0.0.1", 8080)) << host;
  }
}

TEST(OwnAddress, OwnOriginsOnly) {
  EXPECT_TRUE(is_own_origin("http://127.0.0.1:8080", "127.0.0.1", 8080));
  EXPECT_TRUE(is_own_origin("http://localhost:8080", "127.0.0.1", 8080));
  EXPECT_TRUE(is_own_origin("https://localhost", "127.0.0.1", 443, "https"));
  EXPECT_FALSE(is_own_origin("http://127.0.0.1:8080", "127.0.0.1", 8080, "https"));
  for (const char* origin : {"", "null", "https://localhost:8080", "http://localhost:8081",
                             "http://localhost:8080/", "http://example.org", "127.0.0.1:8080"}) {
    EXPECT_FALSE(is_own_origin(origin, "127.0.0.1", 8080)) << origin;
  }
}

}  // namespace
}  // namespace softfinger
