#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "raw_client.hpp"
#include "softfinger/base/error.hpp"
#include "softfinger/viewer/server.hpp"
#include "synthetic_feed.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A fresh key, and a certificate that it has signed itself, as PEM files.
void write_certificate(const Certificate& files) {
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key(EVP_EC_gen("P-256"), EVP_PKEY_free);
  const std::unique_ptr<X509, decltype(&X509_free)> x509(X509_new(), X509_free);
  X509_set_version(x509.get(), X509_VERSION_3);
  ASN1_INTEGER_set(X509_get_serialNumber(x509.get()), 1);
  X509_gmtime_adj(X509_getm_notBefore(x509.get()), -60);
  X509_gmtime_adj(X509_getm_notAfter(x509.get()), 3600);
  X509_set_pubkey(x509.get(), key.get());
  X509_sign(x509.get(), key.get(), EVP_sha256());
  const auto write = [](const fs::path& path, const auto& put) {
    const std::unique_ptr<FILE, int (*)(FILE*)> file(std::fopen(path.c_str(), "w"), std::fclose);
    ASSERT_EQ(put(file.get()), 1) << path;
  };
  write(files.chain, [&](FILE* file) { return PEM_write_X509(file, x509.get()); });
  write(files.key, [&](FILE* file) {
    return PEM_write_PrivateKey(file, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
  });
}

/// What a server on loopback answers over TLS: the header.
std::string header_over_tls(std::uint16_t port, const std::string& request) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  const timeval patience{20, 0};
  ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(
        SSL_CTX_new(TLS_client_method()), SSL_CTX_free);
    const std::unique_ptr<SSL, decltype(&SSL_free)> tls(SSL_new(context.get()), SSL_free);
    SSL_set_fd(tls.get(), socket);
    if (SSL_connect(tls.get()) == 1) {
      SSL_write(tls.get(), request.data(), static_cast<int>(request.size()));
      char byte = 0;
      while (answer.find("\r\n\r\n") == std::string::npos && SSL_read(tls.get(), &byte, 1) == 1) {
        answer += byte;
      }
    }
  }
  ::close(socket);
  return answer;
}

class TlsTest : public ::testing::Test {
 protected:
  TlsTest() { write_certificate(files_); }
  ~TlsTest() override {
    fs::remove(files_.chain);
    fs::remove(files_.key);
  }
  static fs::path named(const std::string& end) {
    return fs::path(::testing::TempDir()) /
           ("softfinger-" + std::to_string(::getpid()) + "-" +
            ::testing::UnitTest::GetInstance()->current_test_info()->name() + end);
  }
  std::string refusal(const Certificate& certificate) {
    try {
      const Server server(feed_, {.port = 0, .certificate = certificate});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  Certificate files_{named(".crt"), named(".key")};
  SyntheticFeed feed_;
};

TEST_F(TlsTest, ServesThePageAndItsWebSocket) {
  const Server server(feed_, {.port = 0, .certificate = files_});
  const std::string own = "127.0.0.1:" + std::to_string(server.port());
  EXPECT_EQ(server.url(), "https://" + own);
  const std::string get = " HTTP/1.1\r\nHost: " + own + "\r\n";
  EXPECT_THAT(header_over_tls(server.port(), "GET /" + get + "\r\n"), StartsWith("HTTP/1.1 200"));
  const std::string upgrade =
      "GET /ws" + get +
      "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
  EXPECT_THAT(header_over_tls(server.port(), upgrade + "Origin: https://" + own + "\r\n\r\n"),
              StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(header_over_tls(server.port(), upgrade + "Origin: http://" + own + "\r\n\r\n"),
              StartsWith("HTTP/1.1 403"))
      << "a page that somebody else could have changed on its way";
}

TEST_F(TlsTest, SpeaksNothingElse) {
  const Server server(feed_, {.port = 0, .certificate = files_});
  RawClient plain(server.port());
  EXPECT_EQ(plain.get("/").status, 0);
  EXPECT_THAT(header_over_tls(server.port(), "GET / HTTP/1.1\r\nHost: 127.0.0.1:" +
                                                 std::to_string(server.port()) + "\r\n\r\n"),
              StartsWith("HTTP/1.1 200"))
      << "others are served all the same";
}

TEST_F(TlsTest, FilesThatAreNoneAreRefused) {
  EXPECT_THAT(refusal({files_.chain, {}}), HasSubstr("--key"));
  EXPECT_THAT(refusal({{}, files_.key}), HasSubstr("--certificate"));
  EXPECT_THAT(refusal({"/no/such/file", files_.key}), StartsWith("--certificate /no/such/file"));
  EXPECT_THAT(refusal({files_.key, files_.key}), StartsWith("--certificate "));
  EXPECT_THAT(refusal({files_.chain, files_.chain}), StartsWith("--key "));
  const Certificate other{named(".other.crt"), named(".other.key")};
  write_certificate(other);
  EXPECT_THAT(refusal({files_.chain, other.key}), StartsWith("--key ")) << "of another certificate";
  fs::remove(other.chain);
  fs::remove(other.key);
}

}  // namespace
}  // namespace softfinger
