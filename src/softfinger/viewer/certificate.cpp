#include "softfinger/viewer/certificate.hpp"

#include <fmt/core.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include <filesystem>
#include <fstream>
#include <utility>

#include "softfinger/base/error.hpp"

namespace softfinger {

TlsContext tls_context(const Certificate& certificate) {
  const std::string chain = certificate.chain.string();
  const std::string key = certificate.key.string();
  if (key.empty()) throw InputError("--certificate: needs --key FILE as well");
  if (chain.empty()) throw InputError("--key: needs --certificate FILE as well");
  for (const auto& [flag, file] : {std::pair("--certificate", chain), std::pair("--key", key)}) {
    if (!std::ifstream(file)) {
      throw InputError(
          fmt::format("{} {}: {}", flag, file,
                      std::filesystem::exists(file) ? "cannot be read" : "no such file"));
    }
  }
  TlsContext context(SSL_CTX_new(TLS_server_method()), SSL_CTX_free);
  if (!context) throw OperationError("TLS is not to be had here");
  SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
  // Never asks for a passphrase: nobody may be there to answer.
  SSL_CTX_set_default_passwd_cb(context.get(), [](char*, int, int, void*) { return 0; });
  const bool certified = SSL_CTX_use_certificate_chain_file(context.get(), chain.c_str()) == 1;
  const bool keyed =
      certified && SSL_CTX_use_PrivateKey_file(context.get(), key.c_str(), SSL_FILETYPE_PEM) == 1 &&
      SSL_CTX_check_private_key(context.get()) == 1;
  ERR_clear_error();
  if (!certified)
    throw InputError(fmt::format("--certificate {}: not a certificate in PEM", chain));
  if (!keyed) {
    throw InputError(
        fmt::format("--key {}: not the private key of {} in PEM without a passphrase", key, chain));
  }
  return context;
}

}  // namespace softfinger
