#pragma once

#include <filesystem>
#include <memory>

struct ssl_ctx_st;  // OpenSSL's SSL_CTX

namespace softfinger {

/// With what a server shows who it is, over TLS. Both or neither.
struct Certificate {
  std::filesystem::path chain;  ///< PEM: the server's certificate, then those that signed it
  std::filesystem::path key;    ///< PEM: its private key, without a passphrase

  [[nodiscard]] bool is_given() const { return !chain.empty() || !key.empty(); }
};

using TlsContext = std::unique_ptr<ssl_ctx_st, void (*)(ssl_ctx_st*)>;

/// What a server's TLS connections, from TLS 1.2 on, begin with. Throws InputError naming
/// --certificate or --key and the file.
[[nodiscard]] TlsContext tls_context(const Certificate& certificate);

}  // namespace softfinger
